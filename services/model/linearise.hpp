// How a machine's acceleration changes close to a state.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// q'' and its partial derivatives; rows and columns beyond the machine's are 0.
struct Linearisation {
  Coordinates acceleration = Coordinates::Zero();  ///< [rad/s^2]
  MassMatrix dq = MassMatrix::Zero();              ///< d q'' / d q [1/s^2]
  MassMatrix dv = MassMatrix::Zero();              ///< d q'' / d q' [1/s]
  Eigen::Matrix<double, kMaxCoordinates, kMaxDrives> torque =
      Eigen::Matrix<double, kMaxCoordinates,
                    kMaxDrives>::Zero();  ///< d q'' / d torque [1/(kg m^2)]
};

/// Exact derivatives, the motor lines' and the contact's included, by dual numbers along every
/// coordinate and rate: the code that makes the acceleration makes them too. Where the model has a
/// corner (a stop, an axle just touching, a drive at its limit) they are those of the side that the
/// state is on. Rotor speeds change as they do at the state. Not finite where acceleration() is
/// not. Does not allocate.
/// @param input its drives are torques added by `torque` where they are within their limits
Linearisation linearise(const Machine& machine, const State& state, const Input& input) noexcept;

}  // namespace gyrotwin::model
