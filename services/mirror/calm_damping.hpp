// A drive that holds hard makes a machine's equations stiff.
#pragma once

#include <array>
#include <cmath>

#include "services/model/machine.hpp"

namespace gyrotwin {

/// 1 / inertia of the coordinate that each drive turns [1 / (kg m^2)].
inline std::array<double, model::kMaxDrives> lightness(const model::Machine& machine,
                                                       const model::State& state) noexcept {
  std::array<double, model::kMaxDrives> lightness{};
  const model::Coordinates at_rest = machine.acceleration(state, {}, {});
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    model::Input pushed;
    pushed.mode = model::DriveMode::kIdealTorque;
    pushed.drive[i] = 1.0;
    const int coordinate = machine.drives[i].coordinate;
    lightness[i] = machine.acceleration(state, pushed, {})[coordinate] - at_rest[coordinate];
  }
  return lightness;
}

/// Share of a coordinate's acceleration that an explicit step [s] bears where a drive holds it with
/// `torque` [N m] against `slip` [rad/s]. Where it comes to rest stays the same, it takes longer;
/// a drive at its limit, which slips fast, is not softened.
inline double calm_share(double lightness, double torque, double slip, double step_s) noexcept {
  // A rate that dies out by e^1.5 in a step is calm; Runge and Kutta's method bears e^2.8.
  const double borne = 1.5 * std::abs(slip);
  const double asked = step_s * lightness * std::abs(torque);
  return asked > borne ? borne / asked : 1.0;
}

}  // namespace gyrotwin
