// A machine's motion under a law, by the tests' own integrator.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "services/model/machine.hpp"
#include "tests/support/extrapolation.hpp"

namespace gyrotwin::reference {

/// The machine from t = 0 until `duration` [s] under `law(t, state) -> Input`; `observe(t, state)`
/// sees the start and every accepted step and ends the run by returning false. @returns the last
/// state seen.
template <typename Law, typename Observe>
model::State simulate(const model::Machine& machine, const model::State& start, double duration,
                      const Law& law, const Tolerance& tolerance, const Observe& observe) {
  constexpr int n = model::kMaxCoordinates;
  using Y = Eigen::Matrix<double, 2 * n + model::kMaxRotors, 1>;
  const auto pack = [](const model::Coordinates& q, const model::Coordinates& v,
                       const model::RotorSpeeds& rotor_speed) {
    Y y;
    y << q, v, Eigen::Map<const Eigen::Matrix<double, model::kMaxRotors, 1>>(rotor_speed.data());
    return y;
  };
  const auto state_of = [](const Y& y) {
    model::State state{y.head<n>(), y.segment<n>(n), {}};
    std::copy_n(y.data() + 2 * n, model::kMaxRotors, state.rotor_speed.begin());
    return state;
  };
  const Y y = pack(start.q, start.v, start.rotor_speed);
  const auto rhs = [&](double t, const Y& x) {
    const model::State state = state_of(x);
    const model::Input input = law(t, state);
    return pack(state.v, machine.acceleration(state, input),
                machine.rotor_acceleration(state, input));
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
