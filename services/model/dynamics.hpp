// M q'' = f + Q of a machine, put together from its tree and what acts on it. Derivation:
// README.md, sections 2 and 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// What carries the machine, its weight included.
inline Support support_of(const Machine& machine, const Input& input) noexcept {
  const Eigen::Vector3d weight(0.0, 0.0, machine.gravity);
  return {input.ground_acceleration + weight, input.yaw_rate};
}

/// M and f. @param rotor_rate n' of the rotors [rad/s^2]
template <class S>
void evaluate(const Machine& machine, const StateOf<S>& state, const Input& input,
              const RotorSpeeds& rotor_rate, MotionOf<S>& motion) noexcept;

/// q'' [rad/s^2], and the motion it came from, with f + Q in place of f.
template <class S>
CoordinatesOf<S> accelerate(const Machine& machine, const StateOf<S>& state, const Input& input,
                            const RotorSpeeds& rotor_rate, MotionOf<S>& motion) noexcept;

}  // namespace gyrotwin::model
