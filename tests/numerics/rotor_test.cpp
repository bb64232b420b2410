// Rotors whose speed is a state: run-up, run-down and what they do to the machine (services/model/
// README.md, section 3).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/integrator/plant.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using model::Coordinates;
using model::Input;
using model::Machine;
using model::Motion;
using model::RotorDrive;
using model::RotorSpeeds;
using model::State;
using reference::Random;

/// One rotor, Ia = 0.002 kg m^2 at 1000 rad/s, on a post that nothing turns.
model::GyroscopeParameters single() {
  return {{1.0, 0.002, 0.003, 0.002, 1000.0, 0.0, 0.1, 10.0, 0.0, 0.0, 0.0, 0.01}, 1.0};
}
constexpr double kIa = 0.002;

Machine single(const RotorDrive& drive) {
  Machine machine = model::build(single());
  machine.rotor_drive = drive;
  return machine;
}

State spinning(const Machine& machine, double speed) {
  State state = machine.state({}, {});
  state.rotor_speed[0] = speed;
  return state;
}

double run(const Machine& machine, double from, double duration, const Input& input = {}) {
  return reference::simulate(machine, spinning(machine, from), duration,
                             [&](double, const State&) { return input; }, {1e-12, 1e-12})
      .rotor_speed[0];
}

Input switched_off() {
  Input input;
  input.rotor_powered.fill(false);
  return input;
}

TEST(Rotor, AtItsSpeedItStaysExactly) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    Machine machine = model::build(random.umbrella());
    machine.rotor_drive = random.rotor_drive();
    EXPECT_EQ(machine.rotor_acceleration(random.state(machine, 0.5, 3.0), {}), RotorSpeeds{});
  }
}

TEST(Rotor, WithoutADriveNothingChangesItsSpeed) {
  Random random(2);
  const Machine machine = model::build(random.umbrella());
  Input input = switched_off();
  input.rotor_brake.fill(1.0);
  EXPECT_EQ(machine.rotor_acceleration(machine.state({}, {}), input), RotorSpeeds{});
}

/// From rest at the full torque until its power is the limit, then at that power:
/// n = tau t / Ia, then n^2 = n1^2 + 2 P (t - t1) / Ia with n1 = P / tau.
TEST(Rotor, RunsUpAtTorqueThenPower) {
  const double tau = 0.2, P = 80.0;
  const Machine machine = single({P, tau, 1e-3, 0.0, 0.0});
  const double n1 = P / tau, t1 = kIa * n1 / tau;              // 400 rad/s after 4 s
  EXPECT_NEAR(run(machine, 0.0, 1.0), tau * 1.0 / kIa, 1e-8);  // measured 5.5e-13
  EXPECT_NEAR(run(machine, 0.0, t1 + 5.0), std::sqrt(n1 * n1 + 2.0 * P * 5.0 / kIa),
              1e-6);  // measured 7.5e-9, over the kink
}

/// Close to its speed the regulator's difference decays with its time constant, drag or not.
TEST(Rotor, RegulatorClosesTheRest) {
  const Machine machine = single({1e6, 1e3, 0.5, 1e-5, 0.01});
  EXPECT_NEAR(run(machine, 900.0, 1.0), 1000.0 - 100.0 * std::exp(-1.0 / 0.5),
              1e-8);  // measured 2.8e-11
  EXPECT_NEAR(run(machine, 1100.0, 1.0), 1000.0 + 100.0 * std::exp(-1.0 / 0.5),
              1e-8);  // measured 2.8e-11
}

/// Where drag takes more than the motor has, it ends where P = drag n.
TEST(Rotor, PowerLimitsTheSpeed) {
  const Machine machine = single({10.0, 0.5, 0.1, 0.0, 0.02});
  EXPECT_NEAR(run(machine, 700.0, 2000.0), 500.0, 1e-6);  // measured 1.5e-11
}

/// Off: Ia n' = -b n - c, so n = (n0 + c/b) exp(-b t / Ia) - c/b; a brake adds to c.
TEST(Rotor, CoastsDownAgainstDragAndBrake) {
  const double b = 1e-4, c = 0.01;
  const Machine machine = single({100.0, 1.0, 0.1, b, c});
  for (const double brake : {0.0, 0.05}) {
    Input input = switched_off();
    input.rotor_brake[0] = brake;
    const double end = (c + brake) / b;
    const double expected = (1000.0 + end) * std::exp(-b * 5.0 / kIa) - end;
    EXPECT_GT(expected, 100.0);
    EXPECT_NEAR(run(machine, 1000.0, 5.0, input), expected, 1e-9);    // measured 1.4e-12
    EXPECT_NEAR(run(machine, -1000.0, 5.0, input), -expected, 1e-9);  // measured 1.4e-12
  }
}

/// Braked to rest it stays there, without passing through.
TEST(Rotor, ComesToRest) {
  const Machine machine = single({100.0, 1.0, 0.1, 0.0, 0.01});
  Input input = switched_off();
  input.rotor_brake[0] = 1.0;
  double lowest = 1.0;
  const State end = reference::simulate(
      machine, spinning(machine, 100.0), 1.0, [&](double, const State&) { return input; },
      {1e-9, 1e-12},
      [&](double, const State& state) {
        lowest = std::min(lowest, state.rotor_speed[0]);
        return true;
      });
  EXPECT_GT(lowest, -1e-9);                    // [rad/s]
  EXPECT_NEAR(end.rotor_speed[0], 0.0, 1e-9);  // [rad/s], measured 9e-12
}

/// Whatever is asked for, at any speed: torque and power stay within the limits, and a hair more
/// speed changes no more than a hair.
TEST(Rotor, LimitsHoldAndNothingJumps) {
  const RotorDrive drive{80.0, 0.2, 0.1, 1e-5, 0.01};
  double worst_power = 0.0, largest_step = 0.0;
  const Machine machine = single(drive);
  double before = machine.rotor_acceleration(spinning(machine, -2000.0), {})[0];
  for (double n = -2000.0; n < 2000.0; n += 0.01) {
    const double rate = machine.rotor_acceleration(spinning(machine, n), {})[0];
    const double torque = kIa * rate + drive.drag(n);
    EXPECT_LE(std::abs(torque), drive.torque_limit * (1 + 1e-12));
    worst_power = std::max(worst_power, std::abs(torque * n));
    largest_step = std::max(largest_step, std::abs(rate - before));
    before = rate;
  }
  EXPECT_LE(worst_power, 80.0 * (1 + 1e-12));
  EXPECT_GT(worst_power, 79.99);
  EXPECT_LT(largest_step, 0.15);  // [rad/s^2], measured 0.1: the regulator's 0.01 / T
}

/// Level umbrella: what speeds all rotors up turns the disc back, -N Ia n' sin tg in the row of
/// phi, and does nothing else.
TEST(Rotor, RunUpTurnsTheDiscBack) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    auto p = random.umbrella();
    p.track = model::TrackKind::kNone;
    Machine machine = model::build(p);
    const State state = random.state(machine, 0.7, 3.0);
    const Coordinates held = machine.acceleration(state, switched_off());
    machine.rotor_drive = RotorDrive{1e9, 1e9, 1.0, 1e-5, 1e-2};
    const double n_t = machine.rotor_acceleration(state, switched_off())[0];
    Motion motion;
    machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {{0, 0, model::kGravity}}, motion);
    Coordinates moment = Coordinates::Zero();
    moment[2] = -p.gyros.count * p.gyros.rotor_inertia * n_t * std::sin(state.q[3]);
    const Coordinates expected = held + machine.tree.solve(motion.M, moment);
    const Coordinates found = machine.acceleration(state, switched_off());
    worst = std::max(
        worst, (found - expected).cwiseAbs().maxCoeff() / (found - held).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-9);  // measured 1.7e-10, of small differences
}

/// On a free post, at an elevation, a rotor that runs up, is braked and runs up again exchanges its
/// momentum with the frame: about the vertical nothing is lost.
TEST(Rotor, MomentumAboutTheVerticalStays) {
  auto p = single();
  p.gyro.cm_distance = 0.05;
  Machine machine = model::build(p);
  machine.rotor_drive = RotorDrive{80.0, 0.2, 0.1, 1e-5, 0.01};
  State start = machine.state({0.0, 0.4}, {0.5, 0.0});
  start.rotor_speed[0] = 300.0;
  const auto schedule = [](double t, const State&) {
    Input input;
    input.rotor_powered[0] = t < 1.0;
    input.rotor_brake[0] = t < 1.0 ? 0.0 : 0.3;
    return input;
  };
  const auto about_z = [&](const State& state) {
    return machine.truth(state, {}).angular_momentum.z();
  };
  const double first = about_z(start);
  double worst = 0.0, slowest = 1e9, fastest = 0.0;
  reference::simulate(machine, start, 2.0, schedule, {1e-11, 1e-12},
                      [&](double, const State& state) {
                        worst = std::max(worst, std::abs(about_z(state) - first));
                        slowest = std::min(slowest, state.rotor_speed[0]);
                        fastest = std::max(fastest, state.rotor_speed[0]);
                        return true;
                      });
  EXPECT_LT(worst, 1e-12);    // [N m s], measured 3.6e-15
  EXPECT_GT(fastest, 390.0);  // [rad/s]
  EXPECT_LT(slowest, 280.0);  // [rad/s]
}

TEST(Plant, RotorSpeedsAreStatesWhereADriveIsPresent) {
  const Machine machine = single({100.0, 1.0, 0.1, 1e-4, 0.01});
  EXPECT_EQ(packed_size(machine), 5);
  EXPECT_EQ(packed_size(model::build(single())), 4);

  Plant plant(machine, 1e-3, {.substeps = 4});
  plant.set_state(spinning(machine, 1000.0));
  const Input off = switched_off();
  ASSERT_TRUE(plant.advance(off));  // the solver takes its memory
  const AllocationCounter allocations;
  for (int k = 1; k < 1000; ++k) ASSERT_TRUE(plant.advance(off));
  EXPECT_EQ(allocations.count(), 0);
  const double end = 0.01 / 1e-4;
  const double expected = (1000.0 + end) * std::exp(-1e-4 * 1.0 / kIa) - end;
  EXPECT_NEAR(plant.state().rotor_speed[0], expected, 1e-9);  // measured 1.8e-12

  // What goes wrong with a rotor stops the plant where it is.
  Input broken;
  broken.rotor_brake[0] = NAN;
  EXPECT_FALSE(plant.advance(broken));
  EXPECT_NEAR(plant.state().rotor_speed[0], expected, 1e-9);
}

TEST(Plant, PacksAndUnpacks) {
  Random random(4);
  for (const bool driven : {false, true}) {
    Machine machine = model::build(random.umbrella());
    if (driven) machine.rotor_drive = random.rotor_drive();
    State state = random.state(machine, 0.5, 2.0);
    state.rotor_speed[1] = 12.5;
    const RotorSpeeds held{1, 2, 3, 4};
    std::array<double, 16> y{};
    pack(machine, state, y.data());
    const State back = unpack(machine, y.data(), held);
    EXPECT_EQ(back.q, state.q);
    EXPECT_EQ(back.v, state.v);
    for (int j = 0; j < machine.rotors; ++j) {
      EXPECT_EQ(back.rotor_speed[j], driven ? state.rotor_speed[j] : held[j]);
    }
  }
}

}  // namespace
}  // namespace gyrotwin
