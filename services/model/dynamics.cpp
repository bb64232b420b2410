#include "services/model/dynamics.hpp"

#include "services/model/forces.hpp"

namespace gyrotwin::model {

namespace {

/// What an added mass does to M and f: as a body of that mass alone.
template <class S>
void add_mass(const Machine& machine, const PointMass& added, MotionOf<S>& motion) {
  const StructurePoint<S> point = structure_point(machine, motion, added.position);
  for (int i = 0; i < machine.coordinates(); ++i) {
    const Vector3<S> m_J = added.mass * point.J[i];
    motion.f[i] -= m_J.dot(point.a0);
    for (int j = 0; j <= i; ++j) motion.M(i, j) += m_J.dot(point.J[j]);
  }
}

}  // namespace

template <class S>
void evaluate(const Machine& machine, const StateOf<S>& state, const Input& input,
              const RotorSpeeds& rotor_rate, MotionOf<S>& motion) noexcept {
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed, rotor_rate},
                        support_of(machine, input), motion);
  for (const PointMass& added : input.added) add_mass(machine, added, motion);
}

template <class S>
CoordinatesOf<S> accelerate(const Machine& machine, const StateOf<S>& state, const Input& input,
                            const RotorSpeeds& rotor_rate, MotionOf<S>& motion) noexcept {
  evaluate(machine, state, input, rotor_rate, motion);
  add_forces(machine, motion, state, input, motion.f);
  return machine.tree.solve(motion.M, motion.f);
}

template void evaluate(const Machine&, const State&, const Input&, const RotorSpeeds&,
                       Motion&) noexcept;
template Coordinates accelerate(const Machine&, const State&, const Input&, const RotorSpeeds&,
                                Motion&) noexcept;
template CoordinatesOf<Dual> accelerate(const Machine&, const StateOf<Dual>&, const Input&,
                                        const RotorSpeeds&, MotionOf<Dual>&) noexcept;

}  // namespace gyrotwin::model
