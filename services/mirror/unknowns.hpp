// What the twin does not know of its rig: the entries of the filter's state. README.md, "The
// filter".
#pragma once

#include <array>

#include "services/mirror/deviations.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Places in the filter's state; -1 where the rig has no such thing. Those before `dynamic` act on
/// the motion, the biases behind it on the readings alone.
struct Unknowns {
  Unknowns(const Rig& rig, const model::Machine& machine);

  int coordinates;                                              ///< q from 0, v from here on
  std::array<int, 2> moment{-1, -1};                            ///< on the structure [N m]
  int friction = -1;                                            ///< of the disc [N m]
  int inertia = -1;                                             ///< share of the structure's [1]
  std::array<int, model::kMaxDrives> strength{-1, -1, -1, -1};  ///< missing of a drive's [1]
  int dynamic = 0;
  std::array<int, 3> gyro_bias{}, accelerometer_bias{};
  int disc_bias = -1;
  std::array<int, model::kMaxGyros> gimbal_bias{-1, -1, -1, -1};
  std::array<int, model::kMaxDrives> current_bias{-1, -1, -1, -1};
  int load_cell_bias = -1;
  int size = 0;

  /// How wide each is at the start, how it walks, and how fast it forgets. Zeros for q and v, but
  /// for the walk of v.
  using PerEntry = std::array<double, Deviations::kMaxColumns>;
  PerEntry prior{};   ///< standard deviation
  PerEntry walk{};    ///< [1/sqrt(s)]
  PerEntry forget{};  ///< 1 / time constant [1/s]
  /// Walks so slowly that it need not every tick; its walk keeps the prior.
  std::array<bool, Deviations::kMaxColumns> slow{};

  double structure_inertia = 0.0;  ///< what `inertia` is a share of [kg m^2]
  double toppling_rate = 0.0;      ///< U/A [1/s^2]
};

}  // namespace gyrotwin
