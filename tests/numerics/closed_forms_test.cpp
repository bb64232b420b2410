// The tree against equations derived by hand (services/model/README.md, sections 2 and 5), on
// random machines in random states.
#include "tests/support/closed_forms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random_machine.hpp"

namespace gyrotwin {
namespace {

using model::Arrangement;
using model::Coordinates;
using model::GimballedParameters;
using model::Input;
using model::Machine;
using model::Mount;
using model::State;
using model::UmbrellaParameters;
using reference::Random;

constexpr int kCases = 300;

/// Largest difference, over the largest component expected.
double difference(const Coordinates& found, const Coordinates& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

TEST(ClosedForms, LevelUmbrella) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < kCases; ++i) {
    UmbrellaParameters p = random.umbrella();
    p.track = model::TrackKind::kNone;
    p.bushing = {};
    const Machine machine = model::build(p);
    const State state = random.state(machine, 1.0, 5.0);  // beyond the stops at 0.8 as well
    Input input;
    input.mode = model::DriveMode::kIdealTorque;
    input.drive[0] = random.between(-5, 5);
    worst = std::max(worst, difference(machine.acceleration(state, input),
                                       reference::level_acceleration(p, state, input.drive[0])));
  }
  EXPECT_LT(worst, 1e-13);  // measured 8.7e-16
}

/// T and V of README.md section 2 hold for every mount.
TEST(ClosedForms, UmbrellaEnergies) {
  Random random(2);
  double worst_T = 0.0, worst_V = 0.0;
  for (const Mount mount : {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint}) {
    for (int i = 0; i < kCases; ++i) {
      UmbrellaParameters p = random.umbrella();
      p.mount = mount;
      p.track = model::TrackKind::kNone;
      p.bushing = {};
      const Machine machine = model::build(p);
      const State state = random.state(machine, 0.7, 5.0);  // inside the stops
      const auto expected = reference::umbrella_energy(p, machine.observe(state));
      const model::Truth truth = machine.truth(state, {});
      worst_T = std::max(worst_T, std::abs(truth.kinetic_energy / expected.T2 - 1.0));
      worst_V = std::max(worst_V, std::abs(truth.potential_energy / expected.V - 1.0));
    }
  }
  EXPECT_LT(worst_T, 1e-14);  // measured 7.8e-16
  EXPECT_LT(worst_V, 1e-14);  // measured 6.7e-16
}

/// Lagrange's equations of those energies, d/dt dT/dv - d(T - V)/dq = 0, by differences along the
/// motion that the tree computes: the dynamics of the mounts that have no closed equations here.
TEST(ClosedForms, UmbrellaObeysLagrange) {
  Random random(3);
  double worst = 0.0;
  for (const Mount mount : {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint}) {
    for (int i = 0; i < kCases; ++i) {
      UmbrellaParameters p = reference::frictionless(random.umbrella());
      p.mount = mount;
      p.track = model::TrackKind::kNone;
      p.bushing = {};
      const Machine machine = model::build(p);
      const State state = random.state(machine, 0.5, 3.0);
      const Coordinates a = machine.acceleration(state, {});
      const auto lagrangian = [&](const Coordinates& q, const Coordinates& v) {
        const auto e = reference::umbrella_energy(p, machine.observe({q, v, state.rotor_speed}));
        return e.T2 + e.T1 - e.V;
      };
      // L is quadratic in v: this difference is exact for any step.
      const auto momentum = [&](int k, const Coordinates& q, const Coordinates& v) {
        const Coordinates e = Coordinates::Unit(k);
        return 0.5 * (lagrangian(q, v + e) - lagrangian(q, v - e));
      };
      // Fourth order in h; the state along the motion to second order is enough for d/dt.
      const double h = 2e-4;
      const auto slope = [h](const auto& f) {
        return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h);
      };
      double scale = 0.0, residual = 0.0;
      for (int k = 0; k < machine.coordinates(); ++k) {
        const double p_rate =
            slope([&](double t) { return momentum(k, state.q + t * state.v, state.v + t * a); });
        const double force = slope(
            [&](double t) { return lagrangian(state.q + t * Coordinates::Unit(k), state.v); });
        scale = std::max({scale, std::abs(p_rate), std::abs(force)});
        residual = std::max(residual, std::abs(p_rate - force));
      }
      worst = std::max(worst, residual / scale);
    }
  }
  EXPECT_LT(worst, 1e-9);  // measured 2.1e-11, of the differences
}

TEST(ClosedForms, Pair) {
  Random random(4);
  double worst = 0.0;
  for (int i = 0; i < kCases; ++i) {
    const GimballedParameters p = random.gimballed(Arrangement::kPair);
    const Machine machine = model::build(p);
    const State state = random.state(machine, 1.2, 3.0);  // beyond the stops at 1.0 as well
    const double u = random.between(-10, 10), moment = random.between(-10, 10);
    Input input;
    input.drive[0] = u;
    input.moment.x() = moment;
    worst = std::max(worst, difference(machine.acceleration(state, input),
                                       reference::pair_acceleration(p, state, u, moment)));
  }
  EXPECT_LT(worst, 1e-13);  // measured 6.1e-15
}

TEST(ClosedForms, TwoPairs) {
  Random random(5);
  double worst = 0.0;
  for (int i = 0; i < kCases; ++i) {
    const GimballedParameters p = random.gimballed(Arrangement::kTwoPairs);
    const Machine machine = model::build(p);
    const State state = random.state(machine, 1.2, 3.0);
    Input input;
    input.drive[0] = random.between(-10, 10);
    input.drive[1] = random.between(-10, 10);
    worst = std::max(worst, difference(machine.acceleration(state, input),
                                       reference::two_pairs_acceleration(p, state, input.drive[0],
                                                                         input.drive[1])));
  }
  EXPECT_LT(worst, 1e-13);  // measured 8.8e-16
}

TEST(ClosedForms, Single) {
  Random random(6);
  double worst = 0.0;
  for (int i = 0; i < kCases; ++i) {
    const GimballedParameters p = random.gimballed(Arrangement::kSingle);
    const Machine machine = model::build(p);
    const State state = random.state(machine, 1.2, 3.0);
    const double u = random.between(-10, 10), moment = random.between(-10, 10);
    Input input;
    input.drive[0] = u;
    input.moment.x() = moment;
    worst = std::max(worst, difference(machine.acceleration(state, input),
                                       reference::single_acceleration(p, state, u, moment)));
  }
  EXPECT_LT(worst, 1e-13);  // measured 3.2e-15
}

}  // namespace
}  // namespace gyrotwin
