#include "services/controller/open_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace gyrotwin {

OpenLoop::OpenLoop(const Rig& rig)
    : wave_(rig.controller.wave),
      amplitude_(rig.controller.amplitude.value()),
      frequency_(rig.controller.frequency.value()),
      phase_(rig.controller.phase.value_or(0.0)),
      drives_(rig.build_machine().drives.size()) {}

DriveTorques OpenLoop::torque(const model::Observation& /*seen*/,
                              const LawState& t) const noexcept {
  const double sine = std::sin(2.0 * std::numbers::pi * frequency_ * t[0] + phase_);
  const double wave = wave_ == Wave::kRelay ? std::copysign(1.0, sine) : sine;
  DriveTorques torques{};
  std::fill_n(torques.begin(), drives_, amplitude_ * wave);
  return torques;
}

std::string OpenLoop::describe() const {
  char text[160];
  std::snprintf(text, sizeof text, "open_loop: %s of %.4g N m at %.4g Hz, phase %.4g rad",
                wave_ == Wave::kRelay ? "relay" : "sine", amplitude_, frequency_, phase_);
  return text;
}

}  // namespace gyrotwin
