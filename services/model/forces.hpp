// What acts on a machine: Q of M q'' = f + Q, and what its springs store. Derivation: README.md,
// section 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// Motion of a point that the structure carries; world axes, as in Frame.
struct StructurePoint {
  Eigen::Vector3d arm;  ///< from the structure's pivot [m]
  Eigen::Vector3d p;    ///< [m]
  Eigen::Vector3d v;    ///< [m/s]
  Eigen::Vector3d a0;   ///< [m/s^2]
  Jacobian J;           ///< d v / d q'_i, for all coordinates
};

/// @param position structure frame [m]
StructurePoint structure_point(const Machine& machine, const Motion& motion,
                               const Eigen::Vector3d& position) noexcept;

/// Rate that a drive works against [rad/s].
double rate_of(const Machine& machine, const Motion& motion, const Drive& drive,
               const State& state) noexcept;

/// What the structure presses on the load cell with [N].
double load_cell_force(const Machine& machine, const Motion& motion, const Input& input) noexcept;

/// Q [N m].
Coordinates all_forces(const Machine& machine, const Motion& motion, const State& state,
                       const Input& input) noexcept;

/// In stops, contact, bushing and load cell [J].
double spring_energy(const Machine& machine, const Motion& motion, const State& state) noexcept;

}  // namespace gyrotwin::model
