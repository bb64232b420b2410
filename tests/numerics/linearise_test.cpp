// The exact Jacobian against extrapolated differences, closed forms and the accelerations it
// belongs to.
#include "services/model/linearise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/model/dual.hpp"
#include "services/model/sine_cosine.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using model::Coordinates;
using model::Dual;
using model::Input;
using model::Linearisation;
using model::Machine;
using model::MassMatrix;
using model::State;
using reference::Random;

/// d q'' / d x along a direction: central differences of steps h, h/2, ... joined by Richardson's
/// extrapolation.
template <class Move>
Coordinates extrapolated(const Machine& machine, const State& state, const Input& input,
                         double step, const Move& move) {
  constexpr int kLevels = 5;
  std::array<Coordinates, kLevels> row;
  for (int level = 0; level < kLevels; ++level) {
    const double h = step / std::pow(2.0, level);
    State ahead = state, behind = state;
    move(ahead, h);
    move(behind, -h);
    row[level] =
        (machine.acceleration(ahead, input) - machine.acceleration(behind, input)) / (2.0 * h);
  }
  for (int order = 1; order < kLevels; ++order) {
    const double gain = std::pow(4.0, order) - 1.0;
    for (int i = kLevels - 1; i >= order; --i) row[i] += (row[i] - row[i - 1]) / gain;
  }
  return row[kLevels - 1];
}

/// Largest difference of both blocks from extrapolated differences, over their largest entry.
double error_at(const Machine& machine, const State& state, const Input& input, double step) {
  const Linearisation about = linearise(machine, state, input);
  double error = 0.0;
  for (int i = 0; i < machine.coordinates(); ++i) {
    const Coordinates dq =
        extrapolated(machine, state, input, step, [i](State& s, double h) { s.q[i] += h; });
    const Coordinates dv =
        extrapolated(machine, state, input, step, [i](State& s, double h) { s.v[i] += h; });
    error = std::max({error, (about.dq.col(i) - dq).cwiseAbs().maxCoeff(),
                      (about.dv.col(i) - dv).cwiseAbs().maxCoeff()});
  }
  return error / std::max(about.dq.cwiseAbs().maxCoeff(), about.dv.cwiseAbs().maxCoeff());
}

TEST(Linearise, AgreesWithDifferencesEverywhere) {
  Random random(31);
  double worst = 0.0;
  for (int round = 0; round < 20; ++round) {
    for (Machine machine : random.machines()) {
      machine.track.reset();  // in contact: the next test
      machine.stops.clear();
      const State state = random.state(machine, 0.6, 4.0);
      worst = std::max(worst, error_at(machine, state, random.input(), 1e-3));
    }
  }
  EXPECT_LT(worst, 1e-9);  // measured 1.7e-11
}

/// All axles on the ring, the stops at work.
TEST(Linearise, AgreesWithDifferencesInContact) {
  Random random(32);
  double worst = 0.0;
  for (int round = 0; round < 20; ++round) {
    for (const auto mount :
         {model::Mount::kLevel, model::Mount::kRigid, model::Mount::kUniversalJoint}) {
      auto p = random.umbrella();
      p.mount = mount;
      p.gyros.stop_lower = p.gyros.ring_elevation + 0.1;
      const Machine machine = model::build(p);
      State state = random.state(machine, 3e-3, 0.3);
      state.q[machine.coordinates() - 1] = p.gyros.ring_elevation - 0.08;
      worst = std::max(worst, error_at(machine, state, random.input(), 3e-4));
    }
  }
  EXPECT_LT(worst, 1e-9);  // measured 6.5e-11
}

TEST(Linearise, TorquesActAsTheyAre) {
  Random random(33);
  double worst = 0.0;
  for (const Machine& machine : random.machines()) {
    const State state = random.state(machine, 0.5, 3.0);
    Input input = random.input();
    input.drive_strength.fill(1.0);
    const Linearisation about = linearise(machine, state, input);
    EXPECT_EQ(about.acceleration, machine.acceleration(state, input));
    for (std::size_t i = 0; i < machine.drives.size(); ++i) {
      Input more = input;
      more.drive[i] += 1.0;
      const Coordinates expected = machine.acceleration(state, more) - about.acceleration;
      const double size = expected.cwiseAbs().maxCoeff();
      const Coordinates found = about.torque.col(static_cast<int>(i));
      worst = std::max(worst, (found - expected).cwiseAbs().maxCoeff() / size);
    }
  }
  EXPECT_LT(worst, 1e-10);  // measured 6.2e-12
}

/// Upright, at rest: the matrix of services/model/README.md, section 5.
TEST(Linearise, UprightPairIsItsReducedModel) {
  Random random(34);
  for (int round = 0; round < 50; ++round) {
    const auto p = random.gimballed(model::Arrangement::kPair);
    const auto r = model::reduce(p);
    const Machine machine = model::build(p);
    const Linearisation about = linearise(machine, machine.state({}, {}), {});
    MassMatrix dq = MassMatrix::Zero(), dv = MassMatrix::Zero();
    dq(0, 0) = r.U / r.A;
    dv.topLeftCorner<2, 2>() << -r.cth / r.A, r.H / r.A, -r.H / r.J, -r.cq / r.J;
    EXPECT_LT((about.dq - dq).cwiseAbs().maxCoeff(), 1e-12 * dq(0, 0));
    EXPECT_LT((about.dv - dv).cwiseAbs().maxCoeff(), 1e-12 * std::abs(dv(1, 0)));
  }
}

/// A motor line's slope is damping; at the torque limit there is none.
TEST(Linearise, DrivesAtTheirLimitsHaveNoSlope) {
  auto p = reference::umbrella("prototype_b");
  p.disc.viscous_friction = p.disc.coulomb_friction = 0.0;
  p.track = model::TrackKind::kNone;
  Machine machine = model::build(p);
  const State state = machine.state({0, 0, 0, 0}, {0, 0, 1, 0});
  const auto& motor = p.drive.motor;
  const double k = motor.torque_constant * motor.gear_ratio;
  const double C = model::reduce(p).C;
  Input input;
  input.mode = model::DriveMode::kVoltage;
  input.drive[0] = 0.5;
  EXPECT_NEAR(linearise(machine, state, input).dv(2, 2), -k * k / motor.resistance / C, 1e-9);
  machine.drives[0].torque_limit = 1e-3;
  EXPECT_NEAR(linearise(machine, state, input).dv(2, 2), 0.0, 1e-20);
}

/// At exact rest, where friction, brakes and dampers give nothing but their slope.
TEST(Linearise, AgreesWithDifferencesAtRest) {
  Random random(36);
  double worst = 0.0;
  for (int round = 0; round < 20; ++round) {
    for (Machine machine : random.machines()) {
      machine.track.reset();
      machine.stops.clear();
      State state = random.state(machine, 0.6, 0.0);
      ASSERT_EQ(state.v, Coordinates::Zero());
      for (const model::DriveMode mode : {model::DriveMode::kTorque, model::DriveMode::kBrake}) {
        Input input;
        input.mode = mode;
        input.drive.fill(mode == model::DriveMode::kBrake ? 0.3 : 0.0);
        worst = std::max(worst, error_at(machine, state, input, 1e-3));
      }
    }
  }
  EXPECT_LT(worst, 1e-8);  // Coulomb friction bends within 0.05 rad/s
}

TEST(Linearise, DoesNotAllocate) {
  Random random(35);
  for (const Machine& machine : random.machines()) {
    const State state = random.state(machine, 0.3, 1.0);
    const Input input = random.input();
    const AllocationCounter allocations;
    [[maybe_unused]] const Linearisation about = linearise(machine, state, input);
    EXPECT_EQ(allocations.count(), 0);
  }
}

TEST(Dual, FollowsTheRulesOfDifferentiation) {
  const Dual x(0.7, 1.0);
  EXPECT_DOUBLE_EQ((x * x / (2.0 + x)).slope, (2 * 0.7 * 2.7 - 0.49) / (2.7 * 2.7));
  Dual sine, cosine;
  model::sine_cosine<1>(&x, &sine, &cosine);
  EXPECT_DOUBLE_EQ((sine * cosine).slope, std::cos(1.4));
  EXPECT_DOUBLE_EQ(sqrt(x).slope, 0.5 / std::sqrt(0.7));
  EXPECT_DOUBLE_EQ(tanh(x).slope, 1.0 / std::pow(std::cosh(0.7), 2));
  EXPECT_DOUBLE_EQ(abs(-x * x).slope, 1.4);
  EXPECT_LT(x, Dual(0.8, -5.0));
}

}  // namespace
}  // namespace gyrotwin
