// A drive that holds hard makes a machine's equations stiff.
#pragma once

#include <algorithm>
#include <array>

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

/// A rate that dies out by e^1.5 in a step is calm; Runge and Kutta's method bears e^2.8.
inline constexpr double kCalm = 1.5;

/// Of each drive's coordinate, the share of its acceleration that explicit steps of this length [s]
/// bear with such a damping on it [N m s/rad]. Where it comes to rest stays the same.
inline std::array<double, model::kMaxDrives> calm_shares(const model::Machine& machine,
                                                         const model::State& state, double damping,
                                                         double step_s) noexcept {
  std::array<double, model::kMaxDrives> shares = lightness(machine, state);
  for (double& share : shares) share = std::min(1.0, kCalm / (step_s * damping * share));
  return shares;
}

}  // namespace gyrotwin
