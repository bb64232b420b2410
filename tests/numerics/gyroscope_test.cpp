// The single gyro on a stand (services/model/README.md, section 5): T = I omega Omega, exactly.
#include "services/model/gyroscope.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/closed_forms.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using model::Coordinates;
using model::GyroscopeParameters;
using model::Input;
using model::Machine;
using model::State;
using reference::Random;

constexpr double g = model::kGravity;

/// A wheel of the size of a bicycle's on a hand's length of axle.
GyroscopeParameters wheel() {
  return {{2.0, 0.05, 0.09, 0.08, 60.0, 0.15, 0.3, 1.0, 2e3, 0.0, 0.0, 0.01}, 5.0};
}

double momentum_of(const GyroscopeParameters& p) {
  return p.gyro.rotor_inertia * p.gyro.rotor_speed;
}

Input weight_at_tip(double weight) {
  Input input;
  input.force.z() = -weight;
  return input;
}

TEST(Gyroscope, IsTheClosedForm) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    const GyroscopeParameters p = random.gyroscope();
    const Machine machine = model::build(p);
    const State state = random.state(machine, 1.2, 5.0);  // beyond the stops at 0.8 as well
    Input input = weight_at_tip(random.between(0, 5));
    input.drive[0] = random.between(-5, 5);
    const Coordinates expected =
        reference::gyroscope_acceleration(p, state, input.drive[0], -input.force.z());
    worst = std::max(worst, (machine.acceleration(state, input) - expected).cwiseAbs().maxCoeff() /
                                expected.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-13);  // measured 1.0e-15
}

/// Level precession at Omega = m g d / h, with more weight at (m g d + F l) / h, is a steady
/// motion: nothing accelerates, and a full turn later the axle is still level.
TEST(Gyroscope, PrecessesLevelWhereMomentumCarriesTheWeight) {
  const GyroscopeParameters p = wheel();
  const Machine machine = model::build(p);
  for (const double weight : {0.0, 1.0}) {
    const double moment = p.gyro.mass * g * p.gyro.cm_distance + weight * p.gyro.axle_length;
    const double rate = moment / momentum_of(p);
    const State start = machine.state({}, {rate, 0.0});
    const Coordinates a = machine.acceleration(start, weight_at_tip(weight));
    EXPECT_LT(a.cwiseAbs().maxCoeff(), 1e-13);  // [rad/s^2], measured 1.8e-15
    const State end =
        reference::simulate(machine, start, 2 * M_PI / rate,
                            [&](double, const State&) { return weight_at_tip(weight); });
    EXPECT_NEAR(end.q[0], 2 * M_PI, 1e-9);  // [rad], measured 2.5e-12
    EXPECT_NEAR(end.q[1], 0.0, 1e-10);      // [rad], measured 2.2e-12
  }
}

/// Released at rest it falls a little, gains its precession from that and nods about the same
/// mean: p_psi = Jpsi psi' + h sin tg stays 0.
TEST(Gyroscope, ReleasedAtRestItPrecessesAndNods) {
  const GyroscopeParameters p = wheel();
  const Machine machine = model::build(p);
  const double rate = p.gyro.mass * g * p.gyro.cm_distance / momentum_of(p);
  double lowest = 0.0, worst = 0.0;
  const double duration = 20.0;
  const State end = reference::simulate(
      machine, machine.state({}, {}), duration, reference::no_input, {1e-11, 1e-13},
      [&](double, const State& state) {
        lowest = std::min(lowest, state.q[1]);
        worst = std::max(worst, std::abs(machine.generalised_momentum(state)[0]));
        return true;
      });
  EXPECT_LT(worst, 1e-12);                               // [N m s], measured 5.3e-15
  EXPECT_LT(lowest, -0.01);                              // [rad], measured -0.027
  EXPECT_NEAR(end.q[0] / duration, rate, 0.001 * rate);  // measured 3e-4 of it
}

/// A drive that turns the post at Omega exerts h Omega cos tg on the elevation: psi' > 0 lifts the
/// tip for h > 0, psi' < 0 presses it down.
TEST(Gyroscope, TurningThePostLiftsTheAxle) {
  GyroscopeParameters p = wheel();
  p.gyro.inertia_axial = p.gyro.inertia_transverse + p.gyro.mass * std::pow(p.gyro.cm_distance, 2);
  const Machine machine = model::build(p);  // Jpsi is the same at every elevation
  const double J = p.gyro.inertia_axial, Omega = 3.0;
  for (const double tg : {-0.5, 0.0, 0.7}) {
    const double up = J * (machine.acceleration(machine.state({0, tg}, {Omega, 0}), {})[1] -
                           machine.acceleration(machine.state({0, tg}, {0, 0}), {})[1]);
    EXPECT_NEAR(up, momentum_of(p) * Omega * std::cos(tg), 1e-12);  // [N m], measured 3.6e-15
    const double down = J * (machine.acceleration(machine.state({0, tg}, {-Omega, 0}), {})[1] -
                             machine.acceleration(machine.state({0, tg}, {0, 0}), {})[1]);
    EXPECT_LT(down, 0.0);
  }
}

/// Friction of the post cannot slow the precession, which the weight dictates; it sinks the axle,
/// at the rate cp Omega / (h cos tg).
TEST(Gyroscope, FrictionOfThePostSinksIt) {
  GyroscopeParameters p = wheel();
  p.gyro.post_damping = 0.02;
  p.gyro.hinge_damping = 0.5;  // takes the nodding out
  const Machine machine = model::build(p);
  const double rate = p.gyro.mass * g * p.gyro.cm_distance / momentum_of(p);
  const double sinking = p.gyro.post_damping * rate / momentum_of(p);
  const State early =
      reference::simulate(machine, machine.state({}, {rate, -sinking}), 1.0, reference::no_input);
  const State late = reference::simulate(machine, early, 10.0, reference::no_input);
  EXPECT_NEAR((early.q[1] - late.q[1]) / 10.0, sinking, 0.01 * sinking);  // measured 3e-4 of it
  EXPECT_NEAR(late.v[0], rate, 0.01 * rate);                              // measured 5e-4 of it
}

TEST(Gyroscope, HasNoTiltAndIsSeenAsDiscAndGimbal) {
  const Machine machine = model::build(wheel());
  const State state = machine.state({0.3, 0.2}, {1.0, -0.5});
  EXPECT_EQ(machine.tilt(state), 0.0);
  const model::Observation seen = machine.observe(state);
  EXPECT_EQ(seen.disc_angle, 0.3);
  EXPECT_EQ(seen.disc_rate, 1.0);
  EXPECT_EQ(seen.gimbal_angle[0], 0.2);
  EXPECT_EQ(seen.gimbal_rate[0], -0.5);
  EXPECT_EQ(seen.rotor_speed[0], 60.0);
}

}  // namespace
}  // namespace gyrotwin
