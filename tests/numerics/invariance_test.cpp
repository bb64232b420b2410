// What must not change: with the numbering of the gyros, between roll and pitch, through
// observation and back; and the contracts of the model's parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using model::Axis;
using model::Body;
using model::Coordinates;
using model::Drive;
using model::DriveMode;
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

std::string refusal(std::vector<Body> bodies, int coordinates) {
  try {
    const Tree tree(std::move(bodies), coordinates);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TreeContract, RefusesWhatItCannotHold) {
  const Body plain;
  EXPECT_EQ(refusal({plain}, 1), "");
  EXPECT_EQ(refusal({plain}, 0), "tree: 1 to 6 coordinates");
  EXPECT_EQ(refusal({plain}, 7), "tree: 1 to 6 coordinates");
  EXPECT_EQ(refusal(std::vector<Body>(7), 1), "tree: at most 6 bodies");
  Body body;
  body.position_parent = 1;
  EXPECT_EQ(refusal({plain, body}, 1), "tree: body 1: parents must come first");
  body = plain;
  body.orientation_parent = 0;
  EXPECT_EQ(refusal({body}, 1), "tree: body 0: parents must come first");
  body = plain;
  body.rotations.assign(5, {Axis::kX, 0});
  EXPECT_EQ(refusal({body}, 1), "tree: body 0: at most 4 rotations");
  body.rotations = {{Axis::kX, 1}};
  EXPECT_EQ(refusal({body}, 1), "tree: body 0: no such coordinate");
  body = plain;
  body.rotor_index = 4;
  EXPECT_EQ(refusal({body}, 1), "tree: body 0: no such rotor");
}

TEST(BuilderContract, UmbrellaHasThreeOrFourGyros) {
  auto p = reference::umbrella("prototype_b");
  for (int count : {2, 5}) {
    p.gyros.count = count;
    EXPECT_THROW(model::build(p), std::invalid_argument);
  }
}

/// Kt G = 0.6 N m/A: numbers that can be followed by hand, exact but for rounding (1e-12).
TEST(DriveContract, MotorLineBoundsIt) {
  const Drive drive{Drive::Kind::kDisc, 2, model::Motor{0.05, 12.0, 0.35, 24.0}, 30.0};
  const double slope = 0.36 / 0.35, stall = 0.6 * 24.0 / 0.35;  // 41.1 N m, above the limit
  EXPECT_EQ(drive.range(0.0)[0], -30.0);
  EXPECT_EQ(drive.range(0.0)[1], 30.0);
  EXPECT_NEAR(drive.range(20.0)[1], stall - 20.0 * slope, 1e-12);
  EXPECT_EQ(drive.range(20.0)[0], -30.0);
  EXPECT_NEAR(drive.range(40.0)[1], 0.0, 1e-12);  // no-load speed Vb / (Kt G)

  EXPECT_EQ(drive.torque(DriveMode::kTorque, 5.0, 20.0), 5.0);
  EXPECT_NEAR(drive.torque(DriveMode::kTorque, 50.0, 20.0), stall - 20.0 * slope, 1e-12);
  EXPECT_EQ(drive.torque(DriveMode::kTorque, -50.0, 20.0), -30.0);
  EXPECT_EQ(drive.torque(DriveMode::kIdealTorque, 50.0, 20.0), 50.0);

  // Voltage: beyond the supply it is cut; at 0 V the motor is shorted and brakes.
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 12.0, 5.0), 0.6 * (12.0 - 3.0) / 0.35, 1e-12);
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 99.0, 20.0), stall - 20.0 * slope, 1e-12);
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 0.0, 5.0), -5.0 * slope, 1e-12);
}

TEST(DriveContract, WithoutMotorTheLimitBoundsIt) {
  const Drive drive{Drive::Kind::kGimbal, 1, std::nullopt, 3.0};
  EXPECT_EQ(drive.range(100.0), (std::array{-3.0, 3.0}));
  EXPECT_EQ(drive.torque(DriveMode::kTorque, 5.0, 100.0), 3.0);
  EXPECT_EQ(drive.torque(DriveMode::kVoltage, 5.0, 100.0), 0.0);
}

/// Turning faster than the supply can follow, the motor only brakes: the range excludes 0.
TEST(DriveContract, OverspeedBrakes) {
  const Drive drive{Drive::Kind::kDisc, 2, model::Motor{0.05, 12.0, 0.35, 24.0}, 1e9};
  EXPECT_LT(drive.range(50.0)[1], 0.0);
  EXPECT_EQ(drive.torque(DriveMode::kTorque, 0.0, 50.0), drive.range(50.0)[1]);
}

TEST(MachineContract, TruthSaysWhatTheDriveStillCan) {
  auto p = reference::umbrella("prototype_b");
  p.drive.torque_limit = 30.0;
  const Machine machine = model::build(p);
  Input input;
  input.drive[0] = -5.0;
  const model::Truth truth = machine.truth(machine.state({}, {0, 0, 20.0, 0}), input);
  EXPECT_EQ(truth.drive_torque[0], -5.0);
  EXPECT_EQ(truth.drive_margin[0], 25.0);

  // A weak drive: of what it would exert, a share arrives.
  input.drive_strength[0] = 0.5;
  const model::Truth weak = machine.truth(machine.state({}, {0, 0, 20.0, 0}), input);
  EXPECT_EQ(weak.drive_torque[0], -2.5);
  EXPECT_EQ(weak.drive_margin[0], 12.5);
}

}  // namespace
}  // namespace gyrotwin
