// Every shipped rig against an independent multibody engine, in random states: accelerations of all
// bodies, with contact, friction, stops, drives and loads; momentum and energy.
#include "tests/engine/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/bodies.hpp"
#include "tests/support/random_machine.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;
using engine::BodyMotion;
using model::Input;
using model::Machine;
using model::State;
using reference::Random;

constexpr int kStates = 25;

/// The same bodies' motions by the model's own tree.
std::vector<BodyMotion> by_model(const Machine& machine, const State& state,
                                 const model::Coordinates& acceleration) {
  std::vector<BodyMotion> motions;
  for (const MovingBody& b : moving_bodies(machine, state, {Vector3d::Zero()}, acceleration)) {
    motions.push_back({b.v, b.omega, b.a, b.alpha});
  }
  return motions;
}

/// Largest differences, over the largest component of the same kind.
struct Difference {
  double velocity = 0.0, acceleration = 0.0, momentum = 0.0, energy = 0.0;

  void take(const Difference& other) {
    velocity = std::max(velocity, other.velocity);
    acceleration = std::max(acceleration, other.acceleration);
    momentum = std::max(momentum, other.momentum);
    energy = std::max(energy, other.energy);
  }
};

template <class Member>
double relative(const std::vector<BodyMotion>& found, const std::vector<BodyMotion>& expected,
                const Member& member) {
  double error = 0.0, size = 1e-3;
  for (std::size_t b = 0; b < found.size(); ++b) {
    error = std::max(error, (member(found[b]) - member(expected[b])).cwiseAbs().maxCoeff());
    size = std::max(size, member(expected[b]).cwiseAbs().maxCoeff());
  }
  return error / size;
}

Difference difference_at(const Rig& rig, const Machine& machine, const State& state,
                         const Input& input) {
  const auto expected = engine::solve(rig, state, input);
  const auto found = by_model(machine, state, machine.acceleration(state, input));
  EXPECT_EQ(found.size(), expected.bodies.size());
  const auto worst = [&](auto linear, auto angular) {
    return std::max(
        relative(found, expected.bodies, [=](const BodyMotion& b) { return b.*linear; }),
        relative(found, expected.bodies, [=](const BodyMotion& b) { return b.*angular; }));
  };
  Difference difference;
  difference.velocity = worst(&BodyMotion::velocity, &BodyMotion::angular_velocity);
  difference.acceleration = worst(&BodyMotion::acceleration, &BodyMotion::angular_acceleration);
  const model::Truth truth = machine.truth(state, input);
  difference.momentum = (truth.angular_momentum - expected.angular_momentum).cwiseAbs().maxCoeff() /
                        expected.angular_momentum.cwiseAbs().maxCoeff();
  // T2 leaves out what the flywheels' spin adds: nothing when they stand.
  State still = state;
  still.rotor_speed = {};
  difference.energy = std::abs(machine.truth(still, input).kinetic_energy /
                                   engine::solve(rig, still, input).kinetic_energy -
                               1.0);
  return difference;
}

/// Loads of the size of the rig's own weight and drives.
Input random_input(Random& random, const Machine& machine, double weight) {
  Input input;
  input.mode = model::DriveMode::kIdealTorque;
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    input.drive[i] = random.between(-1, 1) * machine.drives[i].torque_limit;
  }
  input.force = random.vector(weight);
  input.moment = random.vector(0.2 * weight);
  return input;
}

State random_state(Random& random, const Machine& machine, double angle, double rate) {
  State state = random.state(machine, angle, rate);
  for (double& n : state.rotor_speed) n *= random.between(-1, 1);
  return state;
}

/// Every rig in every mount that its family has.
std::vector<Rig> every_rig() {
  std::vector<Rig> rigs;
  for (const std::string& name : shipped_rigs()) {
    Rig rig = load_rig(name);
    if (auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
      p->drive.motor_inertia = 0.0;  // engine.hpp
      for (const auto mount :
           {model::Mount::kLevel, model::Mount::kRigid, model::Mount::kUniversalJoint}) {
        p->mount = mount;
        rigs.push_back(rig);
      }
    } else {
      rigs.push_back(rig);
    }
  }
  return rigs;
}

Machine constant_rotors(const Rig& rig) {
  Machine machine = rig.build_machine();
  machine.rotor_drive.reset();
  return machine;
}

Difference over_states(unsigned seed, bool on_ring) {
  Random random(seed);
  Difference worst;
  for (const Rig& rig : every_rig()) {
    const Machine machine = constant_rotors(rig);
    const auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine);
    for (int i = 0; i < kStates; ++i) {
      State state = random_state(random, machine, on_ring ? 0.02 : 0.7, 2.0);
      if (on_ring && p != nullptr) {
        state.q[machine.coordinates() - 1] = p->gyros.ring_elevation - random.between(0, 0.03);
      }
      const Difference difference =
          difference_at(rig, machine, state, random_input(random, machine, 50.0));
      worst.take(difference);
    }
  }
  return worst;
}

/// Large tilts and turns, loads, drives, friction, stops and what contact there is.
TEST(Engine, AgreesInRandomStates) {
  const Difference worst = over_states(71, false);
  EXPECT_LT(worst.velocity, 1e-14);      // measured 5.9e-16
  EXPECT_LT(worst.acceleration, 1e-10);  // measured 1.6e-12
  EXPECT_LT(worst.momentum, 1e-13);      // measured 4.9e-15
  EXPECT_LT(worst.energy, 1e-14);        // measured 6.7e-16
}

/// All axles pressed into the ring, where forces are largest.
TEST(Engine, AgreesOnTheRing) {
  const Difference worst = over_states(72, true);
  EXPECT_LT(worst.velocity, 1e-14);      // measured 5.6e-16
  EXPECT_LT(worst.acceleration, 1e-10);  // measured 1.7e-12
  EXPECT_LT(worst.momentum, 1e-13);      // measured 3.0e-15
  EXPECT_LT(worst.energy, 1e-14);        // measured 8.9e-16
}

/// Inertias that bodies can have: no moment is more than the two others.
void make_rigid(Random& random, model::UmbrellaParameters& p) {
  auto& s = p.structure;
  const double steiner = s.mass * s.cm_height * s.cm_height;
  s.inertia_x = steiner + random.between(0.15, 0.25);
  s.inertia_y = steiner + random.between(0.15, 0.25);
  s.inertia_z = random.between(0.15, 0.25);
  p.disc.inertia_planar = random.between(0.05, 0.1);
  p.disc.inertia_polar = random.between(0.02, 0.1);
  p.drive.motor_inertia = 0.0;
  p.gyros.inertia_transverse = random.between(0.005, 0.01);
  p.gyros.inertia_axial = random.between(0.004, 0.009);
  p.gyros.rotor_inertia = random.between(0.2, 0.5) * p.gyros.inertia_axial;
}

/// Random machines have what no shipped rig has: a bushing, a slot, offsets everywhere.
TEST(Engine, AgreesOnRandomMachines) {
  Random random(73);
  Difference worst;
  for (int i = 0; i < 60; ++i) {
    Rig rig;
    auto p = random.umbrella();
    p.track = model::TrackKind::kSlot;
    p.mount = static_cast<model::Mount>(i % 3);
    make_rigid(random, p);
    rig.machine = p;
    if (i % 2 == 0) rig.load_cell = random.load_cell();
    const Machine machine = constant_rotors(rig);
    const State state = random_state(random, machine, 0.1, 3.0);
    worst.take(difference_at(rig, machine, state, random_input(random, machine, 20.0)));
  }
  EXPECT_LT(worst.velocity, 1e-14);      // measured 4.5e-16
  EXPECT_LT(worst.acceleration, 1e-13);  // measured 1.9e-15
  EXPECT_LT(worst.momentum, 1e-13);      // measured 1.7e-15
  EXPECT_LT(worst.energy, 1e-14);        // measured 4.4e-16
}

}  // namespace
}  // namespace gyrotwin
