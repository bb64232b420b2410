// What must not change: with the numbering of the gyros, between roll and pitch, with the shape
// that a machine is said to have, in a turned world, through observation and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/turned_shape.hpp"

namespace gyrotwin {
namespace {

using model::Arrangement;
using model::Axis;
using model::Coordinates;
using model::Input;
using model::kGround;
using model::Machine;
using model::Mount;
using model::Shape;
using model::State;
using model::TrackKind;
using model::Tree;
using reference::Random;

constexpr Mount kMounts[] = {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint};

/// The disc one gyro spacing further is the same machine with the next gyro's number.
TEST(Invariance, GyrosAreAlike) {
  Random random(1);
  double worst_a = 0.0, worst_F = 0.0;
  for (const Mount mount : kMounts) {
    for (int i = 0; i < 100; ++i) {
      auto p = random.umbrella();
      p.mount = mount;
      p.track = TrackKind::kSlot;
      const Machine machine = model::build(p);
      const int N = p.gyros.count;
      const State state = random.state(machine, 0.3, 2.0);
      State turned = state;
      turned.q[machine.layout.disc] += 2.0 * std::numbers::pi / N;

      const Coordinates a = machine.acceleration(state, {});
      worst_a = std::max(worst_a, (machine.acceleration(turned, {}) - a).cwiseAbs().maxCoeff() /
                                      a.cwiseAbs().maxCoeff());
      const model::Truth here = machine.truth(state, {}), there = machine.truth(turned, {});
      for (int j = 0; j < N; ++j) {
        const double F = here.contact_lower[(j + 1) % N];
        worst_F = std::max(worst_F, std::abs(there.contact_lower[j] - F) / (1.0 + F));
      }
    }
  }
  EXPECT_LT(worst_a, 1e-12);  // measured 2.7e-14
  EXPECT_LT(worst_F, 1e-11);  // measured 1.0e-13
}

/// A round structure that rolls about x, turned by 90 deg about the vertical, pitches about y.
TEST(Invariance, RollAndPitchAreAlike) {
  auto p = reference::umbrella("prototype_b");
  p.contact.rolling_drag = 0.0;  // its moment leaves the plane
  const Machine machine = model::build(p);
  const double quarter = std::numbers::pi / 2.0;
  const State roll = machine.state({0.02, 0, 0.0, 0.04}, {0.1, 0, -5.0, 0.2});
  const State pitch = machine.state({0, 0.02, quarter, 0.04}, {0, 0.1, -5.0, 0.2});
  const Coordinates a = machine.acceleration(roll, {}), b = machine.acceleration(pitch, {});
  EXPECT_GT(machine.truth(roll, {}).contact_lower[1], 10.0);  // [N]: the raised side is +y
  for (const auto& [x, y] : {std::pair{a[0], b[1]}, {a[2], b[2]}, {a[3], b[3]}}) {
    EXPECT_NEAR(x, y, 1e-13 * std::abs(x));  // measured 0
  }
}

// The disc of mount `rigid`, turned against the world as the structure is and then by phi.
constexpr Shape kRigidByTheGround =
    Shape()
        .hang(kGround, kGround, {{Axis::kX, 0}, {Axis::kY, 1}})
        .hang(0, kGround, {{Axis::kX, 0}, {Axis::kY, 1}, {Axis::kZ, 2}})
        .gimbal(1, {});

// The gyroscope's post, carried by the axle at the pivot of both.
constexpr Shape kPostOnTheAxle = Shape()
                                     .hang(kGround, kGround, {{Axis::kZ, 0}, {Axis::kY, 1, -1}})
                                     .cm_along(model::kAlongX)
                                     .with_rotor()
                                     .hang(0, kGround, {{Axis::kZ, 0}});

// Without what is known of how bodies and gyros lie.
constexpr Shape anyhow(Shape shape) {
  for (Shape::Joint& joint : shape.bodies.item) joint.pivot = joint.cm = model::kAnywhere;
  for (Shape::Hinge& hinge : shape.gimbals.item) hinge.gyros = {};
  return shape;
}

template <Shape shape>
double change_by_shape(Random& random, const Machine& machine) {
  const State state = random.state(machine, 1.0, 3.0);
  const Input input = random.input();
  const Coordinates a = machine.acceleration(state, input);
  Machine same = machine;
  same.tree = model::make_tree<shape>(machine.tree.bodies(), machine.tree.gimbals());
  return (same.acceleration(state, input) - a).cwiseAbs().maxCoeff() / a.cwiseAbs().maxCoeff();
}

/// Whose child a body is said to be is bookkeeping, and to know how it lies saves work.
TEST(Invariance, ShapesOfTheSameMachineAreAlike) {
  Random random(2);
  double parents = 0.0, lie = 0.0;
  for (int i = 0; i < 50; ++i) {
    const std::vector<Machine> all = random.machines();
    const auto with = [&](double& worst, double change) { worst = std::max(worst, change); };
    with(parents, change_by_shape<kRigidByTheGround>(random, all[1]));
    with(parents, change_by_shape<kPostOnTheAxle>(random, model::build(random.gyroscope())));
    with(lie, change_by_shape<anyhow(shape_of(Mount::kLevel))>(random, all[0]));
    with(lie, change_by_shape<anyhow(shape_of(Mount::kRigid))>(random, all[1]));
    with(lie, change_by_shape<anyhow(shape_of(Mount::kUniversalJoint))>(random, all[2]));
    with(lie, change_by_shape<anyhow(shape_of(Arrangement::kSingle))>(random, all[3]));
    with(lie, change_by_shape<anyhow(shape_of(Arrangement::kPair))>(random, all[4]));
    with(lie, change_by_shape<anyhow(shape_of(Arrangement::kTwoPairs))>(random, all[5]));
    with(lie, change_by_shape<anyhow(model::kGyroscopeShape)>(random, all[6]));
  }
  EXPECT_LT(parents, 1e-13);  // measured 1.6e-14
  EXPECT_LT(lie, 1e-13);      // measured 1.9e-16
}

TEST(Invariance, ShapesMustFitTheirBodies) {
  Random random(4);
  const Machine single = model::build(random.gimballed(Arrangement::kSingle));
  const auto& bodies = single.tree.bodies();
  const auto& gimbals = single.tree.gimbals();
  EXPECT_THROW(model::make_tree<shape_of(Arrangement::kPair)>(bodies, gimbals),
               std::invalid_argument);
  EXPECT_THROW(model::make_tree<shape_of(Arrangement::kTwoPairs)>(bodies, gimbals),
               std::invalid_argument);
  EXPECT_THROW(model::make_tree<model::kGyroscopeShape>(bodies, {}), std::invalid_argument);
}

/// How much M and f + Q change when all that stands in the world is turned about one of its axes:
/// machine, weight, loads, load cell; and the angular momentum.
template <Shape shape, Axis axis>
std::array<double, 3> change_by_turning(Random& random, const Machine& machine) {
  const int n = machine.coordinates();
  const double angle = random.between(-3.0, 3.0);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(static_cast<int>(axis))).toRotationMatrix();
  Machine turned = machine;
  turned.tree = turned_tree<shape, axis>(machine.tree);
  turned.unheld.reset();
  // The cell reads from where its point is in the upright machine, which is not turned.
  model::LoadCell& cell = *turned.load_cell;
  const Eigen::Vector3d along = R * cell.direction;
  cell.rest += (cell.direction - along).dot(cell.point);
  cell.direction = along;

  const State state = random.state(machine, 1.0, 3.0);
  State turned_state = state;
  turned_state.q[n] = angle;
  turned_state.v[n] = 0.0;
  Input input = random.input();
  input.yaw_rate = 0.0;  // is about z wherever the machine lies
  Input turned_input = input;
  turned_input.force = R * input.force;
  turned_input.moment = R * input.moment;
  const Eigen::Vector3d weight(0, 0, machine.gravity);
  turned_input.ground_acceleration = R * (input.ground_acceleration + weight) - weight;

  model::Motion motion, turned_motion;
  model::evaluate(machine, state, input, {}, motion);
  model::evaluate(turned, turned_state, turned_input, {}, turned_motion);
  Coordinates f = motion.f;
  model::add_forces(machine, motion, state, input, f);
  Coordinates turned_f = turned_motion.f;
  model::add_forces(turned, turned_motion, turned_state, turned_input, turned_f);
  turned_f[n] = 0.0;  // the turning's own
  double M_change = 0.0, M_scale = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      M_change = std::max(M_change, std::abs(turned_motion.M(i, j) - motion.M(i, j)));
      M_scale = std::max(M_scale, std::abs(motion.M(i, j)));
    }
  }
  const Eigen::Vector3d L = R * machine.truth(state, input).angular_momentum;
  return {M_change / M_scale, (turned_f - f).cwiseAbs().maxCoeff() / f.cwiseAbs().maxCoeff(),
          (turned.truth(turned_state, turned_input).angular_momentum - L).norm() / L.norm()};
}

template <Shape shape>
void take_changes(Random& random, const Machine& machine, std::array<double, 3>& worst) {
  for (const auto& change : {change_by_turning<shape, Axis::kX>(random, machine),
                             change_by_turning<shape, Axis::kY>(random, machine),
                             change_by_turning<shape, Axis::kZ>(random, machine)}) {
    for (std::size_t i = 0; i < worst.size(); ++i) worst[i] = std::max(worst[i], change[i]);
  }
}

/// On a universal joint there is no room for the coordinate of the turning.
TEST(Invariance, WorldMayBeTurned) {
  Random random(3);
  std::array<double, 3> worst{};
  for (int i = 0; i < 20; ++i) {
    const std::vector<Machine> all = random.machines();
    take_changes<shape_of(Mount::kRigid)>(random, all[1], worst);
    take_changes<shape_of(Arrangement::kSingle)>(random, all[3], worst);
    take_changes<shape_of(Arrangement::kPair)>(random, all[4], worst);
    take_changes<shape_of(Arrangement::kTwoPairs)>(random, all[5], worst);
    take_changes<model::kGyroscopeShape>(random, all[6], worst);
  }
  EXPECT_LT(worst[0], 1e-13);  // measured 0: in its own axes a body does not see it
  EXPECT_LT(worst[1], 1e-12);  // measured 2.0e-14
  EXPECT_LT(worst[2], 1e-12);  // measured 4.0e-16
}

TEST(Invariance, ObservationTellsTheState) {
  Random random(2);
  for (const Machine& machine : random.machines()) {
    const State state = random.state(machine, 0.5, 3.0);
    const State recalled = machine.recall(machine.observe(state));
    EXPECT_EQ(recalled.q, state.q);
    EXPECT_EQ(recalled.v, state.v);
    EXPECT_EQ(recalled.rotor_speed, state.rotor_speed);
  }
}

TEST(Invariance, RigidDiscIsSeenWithTheStructuresTilt) {
  const auto seen = [](Mount mount) {
    auto p = reference::umbrella("prototype_b");
    p.mount = mount;
    const Machine machine = model::build(p);
    return machine.observe(machine.state({0.1, 0.2}, {0.3, 0.4}));
  };
  EXPECT_EQ(seen(Mount::kRigid).disc_tilt, (std::array{0.1, 0.2}));
  EXPECT_EQ(seen(Mount::kRigid).disc_tilt_rate, (std::array{0.3, 0.4}));
  EXPECT_EQ(seen(Mount::kLevel).disc_tilt, (std::array{0.0, 0.0}));
}

TEST(Invariance, EvaluationsDoNotAllocate) {
  Random random(3);
  for (const Machine& machine : random.machines()) {
    const State state = random.state(machine, 0.3, 2.0);
    const Input input = random.input();
    double sum = 0.0;
    const AllocationCounter allocations;
    for (int i = 0; i < 10; ++i) {
      sum += machine.acceleration(state, input)[0] + machine.truth(state, input).kinetic_energy;
      sum += machine.rotor_acceleration(state, input)[0];
      sum += machine.inertial(state, input, machine.push_point).specific_force.x();
      sum += machine.recall(machine.observe(state)).q[0] + machine.drive_rate(0, state);
    }
    EXPECT_EQ(allocations.count(), 0);
    EXPECT_TRUE(std::isfinite(sum));
  }
}

/// Nothing resists the coordinate: the acceleration says so.
TEST(Invariance, SingularIsNotFinite) {
  constexpr Shape kOneAxis = Shape().hang(kGround, kGround, {{Axis::kX, 0}});
  const Machine machine{model::make_tree<kOneAxis>({model::Body()}, {}), {}};
  EXPECT_FALSE(machine.acceleration(machine.state({0.1}, {}), {}).allFinite());

  Random random(5);
  auto weightless = random.gimballed(Arrangement::kPair);
  for (const double inertia : {0.0, -1.0}) {
    weightless.gyros.inertia_transverse = inertia;
    const Machine pair = model::build(weightless);
    EXPECT_FALSE(pair.acceleration(pair.state({0.1, 0.2}, {}), {}).allFinite()) << inertia;
  }
}

/// However much of the equations the compiler leaves out because it is 0.
TEST(Invariance, WhatIsNotFiniteInTheStateShows) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Random random(4);
  for (const Machine& machine : random.machines()) {
    const State sound = random.state(machine, 0.3, 2.0);
    for (const double value : {kNaN, kInfinity, -kInfinity}) {
      const auto expect_shown = [&](const State& state, const char* where, int i) {
        EXPECT_FALSE(machine.acceleration(state, {}).allFinite()) << value << where << i;
      };
      for (int i = 0; i < machine.coordinates(); ++i) {
        State state = sound;
        state.q[i] = value;
        expect_shown(state, " at q ", i);
        state = sound;
        state.v[i] = value;
        expect_shown(state, " at v ", i);
      }
      for (int j = 0; j < machine.rotors; ++j) {
        State state = sound;
        state.rotor_speed[j] = value;
        expect_shown(state, " at rotor ", j);
      }
    }
  }
}

}  // namespace
}  // namespace gyrotwin
