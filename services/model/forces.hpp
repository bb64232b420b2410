// What acts on a machine: Q of M q'' = f + Q, and what its springs store. Derivation: README.md,
// section 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// Motion of a point that the structure carries; in the structure's axes, as in Frame.
template <class S>
struct StructurePoint {
  Vector3<S> p;     ///< world axes [m]
  Vector3<S> v;     ///< [m/s]
  Vector3<S> a0;    ///< [m/s^2]
  JacobianOf<S> J;  ///< d v / d q'_i, for all coordinates
};

/// @param position structure frame [m]
template <class S>
StructurePoint<S> structure_point(const Machine& machine, const MotionOf<S>& motion,
                                  const Eigen::Vector3d& position) noexcept;

/// Rate that a drive works against [rad/s].
template <class S>
S rate_of(const Machine& machine, const MotionOf<S>& motion, const Drive& drive,
          const StateOf<S>& state) noexcept;

/// Q of a torque of 1 N m of a drive [1].
Coordinates drive_direction(const Machine& machine, const Motion& motion,
                            const Drive& drive) noexcept;

/// What the structure presses on the load cell with [N].
double load_cell_force(const Machine& machine, const Motion& motion, const Input& input) noexcept;

/// Adds everything to Q, which may be motion.f [N m]. @return the moment that the structure gives
/// the disc: drive, friction, bushing and contact together; disc axes, 0 without a disc [N m]
template <class S>
Vector3<S> add_forces(const Machine& machine, const MotionOf<S>& motion, const StateOf<S>& state,
                      const Input& input, CoordinatesOf<S>& Q) noexcept;

/// In stops, contact, bushing and load cell [J].
double spring_energy(const Machine& machine, const Motion& motion, const State& state) noexcept;

}  // namespace gyrotwin::model
