// Whether each flywheel keeps the speed that its drive would give it. README.md, "Health".
#pragma once

#include <array>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class RotorWatch {
 public:
  /// @pre rig.sensors @param machine must outlive it
  RotorWatch(const Rig& rig, const model::Machine& machine);
  void reset() noexcept { known_.fill(false); }
  /// One tick. @param speed smoothed [rad/s] @param trusted the sensor says what a rotor can do
  void take(const model::RotorSpeeds& speed, bool trusted, const model::Input& acting) noexcept;
  /// The rotor that is furthest from its speed, -1: all are as they should be.
  int blamed() const noexcept;
  /// What rotor j should run at [rad/s].
  double expected(int j) const noexcept { return expected_.rotor_speed[j]; }

 private:
  const model::Machine& machine_;
  double tick_s_;
  double noise_;           // of the smoothed difference [rad/s]
  model::State expected_;  // rotor speeds alone
  model::RotorSpeeds missing_{};
  std::array<bool, model::kMaxRotors> known_{};
};

}  // namespace gyrotwin
