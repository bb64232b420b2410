#include "services/model/linearise.hpp"

#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"

namespace gyrotwin::model {

namespace {

/// Value and derivative along the direction that the duals of `state` have.
CoordinatesOf<Dual> along(const Machine& machine, const StateOf<Dual>& state, const Input& input,
                          const RotorSpeeds& rotor_rate) {
  MotionOf<Dual> motion;
  return accelerate(machine, state, input, rotor_rate, motion);
}

/// M^-1 times the generalised force of a unit torque of each drive.
void differentiate_by_torque(const Machine& machine, const State& state, const Input& input,
                             Linearisation& about) {
  Motion motion;
  evaluate(machine, state, input, {}, motion);
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const Coordinates unit = drive_direction(machine, motion, machine.drives[i]);
    about.torque.col(static_cast<int>(i)) = machine.tree.solve(motion.M, unit);
  }
}

}  // namespace

Linearisation linearise(const Machine& machine, const State& state, const Input& input) noexcept {
  const RotorSpeeds rotor_rate = machine.rotor_acceleration(state, input);
  StateOf<Dual> moved{state.q.cast<Dual>(), state.v.cast<Dual>(), state.rotor_speed};
  Linearisation about;
  const auto column = [&](Dual& direction, auto&& slopes) {
    direction.slope = 1.0;
    const CoordinatesOf<Dual> acceleration = along(machine, moved, input, rotor_rate);
    direction.slope = 0.0;
    for (int i = 0; i < machine.coordinates(); ++i) slopes[i] = acceleration[i].slope;
  };
  about.acceleration = machine.acceleration(state, input, rotor_rate);
  for (int i = 0; i < machine.coordinates(); ++i) {
    column(moved.q[i], about.dq.col(i));
    column(moved.v[i], about.dv.col(i));
  }
  differentiate_by_torque(machine, state, input, about);
  return about;
}

}  // namespace gyrotwin::model
