#include "tests/support/simulate.hpp"

#include <Eigen/Core>
#include <algorithm>

namespace gyrotwin::reference {

namespace {

constexpr int kN = model::kMaxCoordinates;
static_assert(2 * kN + model::kMaxRotors == kMaxSize);

SmallVector packed(const model::Coordinates& q, const model::Coordinates& v,
                   const model::RotorSpeeds& rotor_speed) {
  SmallVector y(kMaxSize);
  y << q, v, Eigen::Map<const Eigen::Matrix<double, model::kMaxRotors, 1>>(rotor_speed.data());
  return y;
}

model::State state_of(const SmallVector& y) {
  model::State state{y.head<kN>(), y.segment<kN>(kN), {}};
  std::copy_n(y.data() + 2 * kN, model::kMaxRotors, state.rotor_speed.begin());
  return state;
}

}  // namespace

model::State simulate(const model::Machine& machine, const model::State& start, double duration,
                      const Law& law, const Tolerance& tolerance,
                      const std::function<bool(double t, const model::State& state)>& observe) {
  const auto slope = [&](double t, const SmallVector& y) {
    const model::State state = state_of(y);
    const model::Input input = law(t, state);
    return packed(state.v, machine.acceleration(state, input),
                  machine.rotor_acceleration(state, input));
  };
  return state_of(
      integrate(slope, packed(start.q, start.v, start.rotor_speed), 0.0, duration, tolerance,
                [&](double t, const SmallVector& y) { return observe(t, state_of(y)); }));
}

}  // namespace gyrotwin::reference
