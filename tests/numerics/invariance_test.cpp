// What must not change: with the numbering of the gyros, between roll and pitch, with the parents
// of bodies, in a turned world, through observation and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using model::Axis;
using model::Body;
using model::Coordinates;
using model::Input;
using model::Machine;
using model::Mount;
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

/// A body that turns against its parent turns against its parent's parent by the rotations of both.
std::vector<Body> against_grandparents(std::vector<Body> bodies) {
  for (std::size_t b = bodies.size(); b-- > 0;) {
    if (bodies[b].orientation_parent == model::kGround) continue;
    const Body& parent = bodies[static_cast<std::size_t>(bodies[b].orientation_parent)];
    std::vector<model::Rotation> rotations = parent.rotations;
    rotations.insert(rotations.end(), bodies[b].rotations.begin(), bodies[b].rotations.end());
    if (rotations.size() > 4) continue;
    bodies[b].orientation_parent = parent.orientation_parent;
    bodies[b].rotations = rotations;
  }
  return bodies;
}

/// A pivot that is its neighbour's pivot may as well be carried by the neighbour.
std::vector<Body> carried_by_neighbours(std::vector<Body> bodies) {
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const Body& before = bodies[b - 1];
    if (bodies[b].position_parent != before.position_parent || bodies[b].pivot != before.pivot) {
      continue;
    }
    bodies[b].position_parent = static_cast<int>(b) - 1;
    bodies[b].pivot.setZero();
  }
  return bodies;
}

/// Whose child a body is said to be is bookkeeping.
TEST(Invariance, ParentsAreBookkeeping) {
  Random random(2);
  double worst = 0.0;
  int turned = 0, carried = 0;
  for (int i = 0; i < 50; ++i) {
    for (const Machine& machine : random.machines()) {
      const std::vector<Body>& bodies = machine.tree.bodies();
      const State state = random.state(machine, 1.0, 3.0);
      const Input input = random.input();
      const Coordinates a = machine.acceleration(state, input);
      for (const auto& other : {against_grandparents(bodies), carried_by_neighbours(bodies)}) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          turned += other[b].orientation_parent != bodies[b].orientation_parent;
          carried += other[b].position_parent != bodies[b].position_parent;
        }
        Machine same = machine;
        same.tree = Tree(other, machine.coordinates());
        worst = std::max(worst, (same.acceleration(state, input) - a).cwiseAbs().maxCoeff() /
                                    a.cwiseAbs().maxCoeff());
      }
    }
  }
  EXPECT_GT(turned, 500);
  EXPECT_GT(carried, 100);
  EXPECT_LT(worst, 1e-14);  // measured 0: the same operations
}

/// All that stands in the world turned about one of its axes: machine, weight, loads, load cell.
TEST(Invariance, WorldMayBeTurned) {
  Random random(3);
  double worst_a = 0.0, worst_L = 0.0;
  for (int i = 0; i < 60; ++i) {
    for (const Machine& machine : random.machines()) {
      const Axis axis = static_cast<Axis>(i % 3);
      const double angle = random.between(-3.0, 3.0);
      const Eigen::Matrix3d R =
          Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(i % 3)).toRotationMatrix();
      std::vector<Body> bodies = machine.tree.bodies();
      for (Body& body : bodies) {
        if (body.orientation_parent != model::kGround) continue;
        body.rotations.insert(body.rotations.begin(), {axis, model::kFixed, 1.0, angle});
      }
      Machine turned = machine;
      turned.tree = Tree(bodies, machine.coordinates());
      // The cell reads from where its point is in the upright machine, which is not turned.
      model::LoadCell& cell = *turned.load_cell;
      const Eigen::Vector3d along = R * cell.direction;
      cell.rest += (cell.direction - along).dot(cell.point);
      cell.direction = along;

      const State state = random.state(machine, 1.0, 3.0);
      Input input = random.input();
      input.yaw_rate = 0.0;  // is about z wherever the machine lies
      Input turned_input = input;
      turned_input.force = R * input.force;
      turned_input.moment = R * input.moment;
      const Eigen::Vector3d weight(0, 0, machine.gravity);
      turned_input.ground_acceleration = R * (input.ground_acceleration + weight) - weight;

      const Coordinates a = machine.acceleration(state, input);
      worst_a =
          std::max(worst_a, (turned.acceleration(state, turned_input) - a).cwiseAbs().maxCoeff() /
                                a.cwiseAbs().maxCoeff());
      const Eigen::Vector3d L = R * machine.truth(state, input).angular_momentum;
      worst_L = std::max(
          worst_L, (turned.truth(state, turned_input).angular_momentum - L).norm() / L.norm());
    }
  }
  EXPECT_LT(worst_a, 1e-11);  // measured 8.2e-14
  EXPECT_LT(worst_L, 1e-12);  // measured 1.2e-15
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
  Body body;
  body.rotations = {{Axis::kX, 0}};
  Machine machine{Tree({body}, 1), {}};
  EXPECT_FALSE(machine.acceleration(machine.state({0.1}, {}), {}).allFinite());
}

}  // namespace
}  // namespace gyrotwin
