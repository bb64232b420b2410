// A machine's motion under a law, by the tests' own integrator.
#pragma once

#include <Eigen/Core>

#include "services/model/machine.hpp"
#include "tests/support/extrapolation.hpp"

namespace gyrotwin::reference {

/// The machine from t = 0 until `duration` [s] under `law(t, state) -> Input`; `observe(t, state)`
/// sees the start and every accepted step and ends the run by returning false. @returns the last
/// state seen.
template <typename Law, typename Observe>
model::State simulate(const model::Machine& machine, const model::State& start, double duration,
                      const Law& law, const Tolerance& tolerance, const Observe& observe) {
  using Y = Eigen::Matrix<double, 2 * model::kMaxCoordinates, 1>;
  const auto state_of = [&start](const Y& y) {
    return model::State{y.head<model::kMaxCoordinates>(), y.tail<model::kMaxCoordinates>(),
                        start.rotor_speed};
  };
  Y y;
  y << start.q, start.v;
  const auto rhs = [&](double t, const Y& x) {
    const model::State state = state_of(x);
    Y dx;
    dx << state.v, machine.acceleration(state, law(t, state));
    return dx;
  };
  return state_of(integrate(rhs, y, 0.0, duration, tolerance,
                            [&](double t, const Y& x) { return observe(t, state_of(x)); }));
}

template <typename Law>
model::State simulate(const model::Machine& machine, const model::State& start, double duration,
                      const Law& law, const Tolerance& tolerance = {}) {
  return simulate(machine, start, duration, law, tolerance,
                  [](double, const model::State&) { return true; });
}

/// The law of a machine left alone.
inline model::Input no_input(double /*t*/, const model::State& /*state*/) { return {}; }

}  // namespace gyrotwin::reference
