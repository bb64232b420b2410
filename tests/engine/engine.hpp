// The machines once more, in Simbody: another author's multibody code, other coordinates, loops
// closed by constraints, flywheels as bodies that turn.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::engine {

/// One body at one instant; world axes.
struct BodyMotion {
  Eigen::Vector3d velocity;              ///< of the centre of mass [m/s]
  Eigen::Vector3d angular_velocity;      ///< [rad/s]
  Eigen::Vector3d acceleration;          ///< of the centre of mass [m/s^2]
  Eigen::Vector3d angular_acceleration;  ///< [rad/s^2]
};

/// What the engine finds.
struct Found {
  std::vector<BodyMotion> bodies;    ///< in the order of the machine's
  Eigen::Vector3d angular_momentum;  ///< of everything about the ground pivot [N m s]
  double kinetic_energy;             ///< the flywheels' turning included [J]
};

/// Builds the rig's machine from its parameters and asks for its accelerations. Everything of
/// services/model/README.md, section 3, acts on it, worked out from the engine's own kinematics.
/// Rotors keep their speeds relative to their frames. The inertia that a geared motor adds to the
/// disc's axis is left out: no rigid body has it.
/// @param input ideal torques, and the wrench on the structure
Found solve(const Rig& rig, const model::State& state, const model::Input& input);

}  // namespace gyrotwin::engine
