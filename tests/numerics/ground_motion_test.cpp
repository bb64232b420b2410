// Machines on a support that accelerates and turns (services/model/README.md, section 2).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/turned_shape.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;
using model::Arrangement;
using model::Axis;
using model::Coordinates;
using model::Input;
using model::kGround;
using model::Machine;
using model::Motion;
using model::Mount;
using model::Shape;
using model::State;
using model::TrackKind;
using model::Tree;
using reference::Random;

constexpr double g = model::kGravity;
constexpr Arrangement kArrangements[] = {Arrangement::kSingle, Arrangement::kPair,
                                         Arrangement::kTwoPairs};

std::vector<Machine> every_machine(Random& random) {
  std::vector<Machine> machines;
  for (const Mount mount : {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint}) {
    auto p = random.umbrella();
    p.mount = mount;
    p.track = TrackKind::kNone;  // at these tilts its forces would drown everything
    machines.push_back(model::build(p));
  }
  for (const auto arrangement : kArrangements) {
    machines.push_back(model::build(random.gimballed(arrangement)));
  }
  machines.push_back(model::build(random.gyroscope()));
  return machines;
}

struct Trees {
  Tree tree, with_yaw;
};

template <Shape shape>
Trees trees_of(const Machine& machine) {
  const Tree tree = model::make_tree<shape>(machine.tree.bodies(), machine.tree.gimbals());
  return {tree, turned_tree<shape, Axis::kZ>(tree)};
}

// With the disc held, to make room for the yaw.
constexpr Shape kHeldDisc = Shape()
                                .hang(kGround, kGround, {{Axis::kX, 0}, {Axis::kY, 1}})
                                .hang(0, kGround, {{Axis::kX, 2}, {Axis::kY, 3}})
                                .gimbal(1, {});

/// As every_machine() has them.
constexpr Trees (*kTreesOf[])(const Machine&) = {
    trees_of<shape_of(Mount::kLevel)>,
    trees_of<shape_of(Mount::kRigid)>,
    trees_of<kHeldDisc>,
    trees_of<shape_of(Arrangement::kSingle)>,
    trees_of<shape_of(Arrangement::kPair)>,
    trees_of<shape_of(Arrangement::kTwoPairs)>,
    trees_of<model::kGyroscopeShape>,
};

/// A steady turn is a yaw coordinate whose second derivative is kept 0: the rows of all other
/// coordinates are the same, whatever the yaw angle.
TEST(GroundMotion, TurnIsAYawAtConstantRate) {
  Random random(1);
  double worst_M = 0.0, worst_f = 0.0, effect = 0.0;
  for (int i = 0; i < 100; ++i) {
    const auto machines = every_machine(random);
    for (std::size_t k = 0; k < machines.size(); ++k) {
      const auto [tree, with_yaw] = kTreesOf[k](machines[k]);
      const int n = tree.coordinates();
      const State state = random.state(machines[k], 0.7, 3.0);
      const double yaw_rate = random.between(-2, 2);
      Coordinates q = state.q, v = state.v;
      Motion turning, resting, driven;
      tree.evaluate(q, v, {state.rotor_speed}, {Vector3d(0, 0, g), yaw_rate}, turning);
      tree.evaluate(q, v, {state.rotor_speed}, {Vector3d(0, 0, g)}, resting);
      q[n] = random.between(-3, 3);
      v[n] = yaw_rate;
      with_yaw.evaluate(q, v, {state.rotor_speed}, {Vector3d(0, 0, g)}, driven);

      const double f_scale = turning.f.cwiseAbs().maxCoeff();
      const double M_scale = resting.M.diagonal().head(n).maxCoeff();
      for (int row = 0; row < n; ++row) {
        worst_f = std::max(worst_f, std::abs(turning.f[row] - driven.f[row]) / f_scale);
        effect = std::max(effect, std::abs(turning.f[row] - resting.f[row]) / f_scale);
        for (int column = 0; column <= row; ++column) {
          worst_M =
              std::max(worst_M, std::abs(turning.M(row, column) - driven.M(row, column)) / M_scale);
        }
      }
    }
  }
  EXPECT_LT(worst_f, 1e-13);  // measured 1.4e-15
  EXPECT_LT(worst_M, 1e-13);  // measured 8.8e-16
  EXPECT_GT(effect, 0.1);
}

/// A support in free fall takes weight away, and an added mass' as well.
TEST(GroundMotion, FreeFallIsWeightless) {
  Random random(2);
  for (Machine machine : every_machine(random)) {
    const State state = random.state(machine, 0.5, 2.0);
    Input input;
    input.added.add({1.0, {0.1, 0.2, 0.3}});
    Machine weightless = machine;
    weightless.gravity = 0.0;
    const Coordinates expected = weightless.acceleration(state, input);
    input.ground_acceleration.z() = -g;
    EXPECT_EQ(machine.acceleration(state, input), expected);
  }
}

/// Level umbrella: V gains a.(S z_S) with S = ms r + ma hd, the moment that U has from weight, and
/// nothing else, for the disc stays level and its gyros balance each other.
TEST(GroundMotion, AccelerationTopplesTheUmbrella) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    const auto p = random.umbrella();
    const Machine machine = model::build(p);
    const State state = random.state(machine, 0.7, 2.0);
    const double S = p.structure.mass * p.structure.cm_height +
                     (p.disc.mass + p.gyros.count * p.gyros.mass) * p.disc.joint_height;
    const Vector3d a(random.between(-5, 5), random.between(-5, 5), 0.0);
    Motion pushed, resting;
    machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {a}, pushed);
    machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d::Zero()}, resting);
    const double sx = std::sin(state.q[0]), cx = std::cos(state.q[0]);
    const double sy = std::sin(state.q[1]), cy = std::cos(state.q[1]);
    Coordinates expected = Coordinates::Zero();
    expected[0] = S * a.y() * cx * cy;
    expected[1] = -S * (a.x() * cy + a.y() * sx * sy);
    worst = std::max(worst, (pushed.f - resting.f - expected).cwiseAbs().maxCoeff() /
                                resting.f.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-13);  // measured 6.6e-15
}

struct Turn {
  State state;
  Motion turning, resting;
};

/// What a turn changes, with the support's acceleration `a` to the left.
Turn turn(const Machine& machine, const State& state, double a, double yaw_rate) {
  Turn t{state, {}, {}};
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d(0, a, 0), yaw_rate},
                        t.turning);
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d::Zero()}, t.resting);
  return t;
}

/// Centrifugal moment m v r zc cos th, outward: the same for one gyro as for two.
TEST(GroundMotion, CentrifugalForceActsAtTheHeight) {
  Random random(4);
  for (const auto arrangement : {Arrangement::kSingle, Arrangement::kPair}) {
    for (int i = 0; i < 100; ++i) {
      const auto p = random.gimballed(arrangement);
      const Machine machine = model::build(p);
      const State state = random.state(machine, 0.7, 2.0);
      const double a = random.between(-5, 5);
      const Turn t = turn(machine, state, a, 0.0);
      const double moment = p.structure.mass * a * p.structure.cm_height * std::cos(state.q[0]);
      EXPECT_NEAR(t.turning.f[0] - t.resting.f[0], moment,
                  1e-12 * std::abs(a));  // [N m], measured 1.5e-14
      EXPECT_EQ(t.turning.f[1], t.resting.f[1]);
    }
  }
}

/// A rotor at h in a turn at r: -h r cos q sin th on the tilt, -h r sin q cos th on the gimbal of
/// the gyro car, which to first order is a spring -h r on its precession. A pair cancels both.
TEST(GroundMotion, RotorsFeelTheTurn) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const auto p = random.gimballed(Arrangement::kSingle);
    const double h = p.gyros.rotor_inertia * p.gyros.rotor_speed, r = random.between(-1, 1);
    auto still = p;
    still.gyros.rotor_speed = 0.0;
    const Machine machine = model::build(p), without_momentum = model::build(still);
    State state = random.state(machine, 0.7, 2.0);
    const Turn spinning = turn(machine, state, 0.0, r);
    state.rotor_speed = {};
    const Turn standing = turn(without_momentum, state, 0.0, r);
    const Coordinates by_rotor =
        spinning.turning.f - spinning.resting.f - (standing.turning.f - standing.resting.f);
    const double th = state.q[0], q = state.q[1];
    EXPECT_NEAR(by_rotor[0], -h * r * std::cos(q) * std::sin(th),
                1e-12);  // [N m], measured 1.9e-14
    EXPECT_NEAR(by_rotor[1], -h * r * std::sin(q) * std::cos(th),
                1e-12);  // [N m], measured 3.6e-15
  }
  auto p = random.gimballed(Arrangement::kPair);
  const Machine pair = model::build(p);
  State state = random.state(pair, 0.7, 2.0);
  const Turn spinning = turn(pair, state, 0.0, 1.0);
  state.rotor_speed = {};
  const Turn standing = turn(pair, state, 0.0, 1.0);
  const Coordinates by_rotors =
      spinning.turning.f - spinning.resting.f - (standing.turning.f - standing.resting.f);
  EXPECT_LT(by_rotors.cwiseAbs().maxCoeff(), 1e-13);  // [N m], measured 3.1e-15
}

/// Nothing that acts between two bodies, nor the load cell, feels the turning of world axes.
TEST(GroundMotion, InternalForcesDoNotFeelTheTurn) {
  Random random(6);
  double largest = 0.0;
  for (int i = 0; i < 100; ++i) {
    auto p = random.umbrella();
    p.track = TrackKind::kSlot;
    p.mount = Mount::kUniversalJoint;
    Machine machine = model::build(p);
    machine.load_cell = random.load_cell();
    const State state = random.state(machine, 0.3, 2.0);
    Input turning;
    turning.yaw_rate = 3.0;
    const model::Truth a = machine.truth(state, {}), b = machine.truth(state, turning);
    for (int j = 0; j < p.gyros.count; ++j) {
      EXPECT_NEAR(a.contact_lower[j], b.contact_lower[j],
                  1e-11 * (1.0 + a.contact_lower[j]));  // measured 1e-15
      largest = std::max(largest, a.contact_lower[j]);
    }
    EXPECT_NEAR(a.load_cell, b.load_cell, 1e-12 * std::abs(a.load_cell));  // measured 1e-15
    EXPECT_EQ(a.kinetic_energy, b.kinetic_energy);
    EXPECT_EQ(a.potential_energy, b.potential_energy);
  }
  EXPECT_GT(largest, 10.0);  // [N]
}

/// An IMU's readings, from its path through space by differences.
TEST(GroundMotion, InertialReadingIsThePathThroughSpace) {
  Random random(7);
  double worst_a = 0.0, worst_w = 0.0;
  for (int i = 0; i < 50; ++i) {
    for (const Machine& machine : every_machine(random)) {
      const State state = random.state(machine, 0.7, 2.0);
      const Vector3d point = random.vector(0.5);
      Input input;
      input.ground_acceleration = random.vector(3.0);
      input.yaw_rate = random.between(-2, 2);
      input.added.add({random.between(0, 2), random.vector(0.3)});
      const Coordinates a = machine.acceleration(state, input);

      // Orientation in space a time t later, to second order in t.
      const auto orientation = [&](double t) {
        Motion motion;
        machine.tree.evaluate<double>(state.q + t * state.v + 0.5 * t * t * a, Coordinates::Zero(),
                                      {state.rotor_speed}, {Vector3d::Zero()}, motion);
        return Eigen::Matrix3d(Eigen::AngleAxisd(input.yaw_rate * t, Vector3d::UnitZ()) *
                               motion.frame[0].R);
      };
      const double h = 1e-3;
      const Eigen::Matrix3d R = orientation(0.0), R1 = orientation(h), R_1 = orientation(-h),
                            R2 = orientation(2 * h), R_2 = orientation(-2 * h);
      const Eigen::Matrix3d R_t = (8.0 * (R1 - R_1) - (R2 - R_2)) / (12.0 * h);
      const Eigen::Matrix3d R_tt = (16.0 * (R1 + R_1) - (R2 + R_2) - 30.0 * R) / (12.0 * h * h);
      const Eigen::Matrix3d W = R.transpose() * R_t;
      const Vector3d omega(W(2, 1), W(0, 2), W(1, 0));
      const Vector3d force =
          R.transpose() * (R_tt * point + input.ground_acceleration + Vector3d(0, 0, g));

      const model::InertialReading reading = machine.inertial(state, input, point);
      worst_w = std::max(worst_w, (reading.angular_velocity - omega).norm() / omega.norm());
      worst_a = std::max(worst_a, (reading.specific_force - force).norm() / force.norm());
    }
  }
  EXPECT_LT(worst_w, 1e-6);  // measured 6.3e-8, of the differences
  EXPECT_LT(worst_a, 1e-6);  // measured 2.6e-8, of the differences
}

/// Leaning into a turn by tan th = v r / g, a vehicle whose own inertia is small to its weight is
/// in balance, and what it feels points along its own axis.
TEST(GroundMotion, LeaningIntoTheTurnBalances) {
  const Machine machine = model::build(reference::gimballed("brennan_monorail"));
  const double r = 0.02, speed = 50.0;  // [rad/s], [m/s]
  const State state = machine.state({-std::atan(speed * r / g), 0.0}, {});
  Input input;
  input.ground_acceleration.y() = speed * r;
  input.yaw_rate = r;
  const double toppling = std::abs(machine.acceleration(machine.state({}, {}), input)[0]);
  EXPECT_LT(std::abs(machine.acceleration(state, input)[0]), 1e-3 * toppling);  // measured 7e-5
  const Vector3d force = machine.inertial(state, input, machine.push_point).specific_force;
  EXPECT_NEAR(force.z(), std::hypot(g, speed * r), 1e-4);  // measured 6e-6
  EXPECT_NEAR(force.y(), 0.0, 1e-4);                       // measured 1.2e-5
}

}  // namespace
}  // namespace gyrotwin
