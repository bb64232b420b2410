// What the machines do under simple laws: who stays up, who falls, and where they come to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using model::Input;
using model::Machine;
using model::Mount;
using model::State;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFallen = 0.7;  // [rad]

/// Proportional-integral speed law of the disc, torque limited. The integral of the speed error is
/// known in closed form from the angle.
struct ConstantSpeed {
  double speed, kp, ki, torque_max;
  double initial_angle = 0.0;

  double torque(const Machine& machine, double t, const State& state) const {
    const int phi = machine.layout.disc;
    const double error = speed - state.v[phi];
    const double integral = speed * t - (state.q[phi] - initial_angle);
    return std::clamp(kp * error + ki * integral, -torque_max, torque_max);
  }
};

struct Outcome {
  State last;
  double time = 0.0;       ///< reached before falling [s]
  double peak_tilt = 0.0;  ///< [rad]
};

template <typename Law>
Outcome run(const Machine& machine, const State& start, double duration, const Law& law,
            const reference::Tolerance& tolerance = {1e-8, 1e-10}) {
  Outcome result;
  result.last = reference::simulate(
      machine, start, duration, law, tolerance, [&](double t, const State& state) {
        result.time = t;
        result.peak_tilt = std::max(result.peak_tilt, machine.tilt(state));
        return machine.tilt(state) < kFallen;
      });
  return result;
}

Machine umbrella(const std::string& set, Mount mount) {
  auto p = reference::umbrella(set);
  p.mount = mount;
  return model::build(p);
}

/// The thesis' inequality at work: H^2 > C U, or not, in mount `level`, released 2 deg off with the
/// axles on the ring, the disc turning just so that its momentum is 0. Contact damping alone takes
/// energy.
Outcome released(const std::string& set, double duration) {
  auto p = reference::frictionless(reference::umbrella(set));
  p.contact.damping = reference::umbrella(set).contact.damping;
  const Machine machine = model::build(p);
  const auto r = model::reduce(p);
  const double elevation = r.k * 2.0 * kDegree;
  return run(
      machine,
      machine.state({2.0 * kDegree, 0, 0, elevation}, {0, 0, -r.Nh * std::sin(elevation) / r.C, 0}),
      duration, reference::no_input);
}

TEST(Level, PrototypeAFallsFree) {
  const Outcome a = released("prototype_a", 4.0);
  EXPECT_LT(a.time, 2.5);  // [s], measured 1.92
  EXPECT_GT(a.peak_tilt, kFallen);
}

TEST(Level, PrototypeBStaysUpFree) {
  const Outcome b = released("prototype_b", 4.0);
  EXPECT_EQ(b.time, 4.0);
  EXPECT_LT(b.peak_tilt, 2.1 * kDegree);  // measured 2.00001 deg
}

/// The external support's moment is the opposite of everything that topples: the moment applied and
/// the weight's, -(M + U sin thx cos thy), once the platform rests against the ring.
TEST(Level, SupportSuppliesTheRestoringMoment) {
  const auto p = reference::umbrella("prototype_b");
  const Machine machine = model::build(p);
  const ConstantSpeed law{-5.0, 3.0, 6.0, 100.0};
  const double moment = 20.0;
  const auto input = [&](double t, const State& state) {
    Input u;
    u.mode = model::DriveMode::kIdealTorque;
    u.drive[0] = law.torque(machine, t, state);
    u.moment.x() = moment;
    return u;
  };
  const double duration = 4.0;
  const Outcome pushed = run(machine, machine.state({}, {0, 0, -5.0, 0}), duration, input);
  const State& rest = pushed.last;
  const double U = model::reduce(p).U;
  const double expected = -(moment + U * std::sin(rest.q[0]) * std::cos(rest.q[1]));
  const auto holding = machine.truth(rest, input(duration, rest)).holding_moment;
  EXPECT_LT(machine.tilt(rest), 0.1 * kDegree);  // measured 0.061 deg
  EXPECT_NEAR(expected, -20.02, 0.005);          // [N m], measured -20.0193
  EXPECT_NEAR(holding[0], expected, 0.001);      // [N m], measured 6.7e-5: it still settles
}

/// With the gyros horizontal the disc takes the moment that it gives: both real mounts fall, alike,
/// under the law that holds mount `level` below 0.001 deg.
TEST(FreeDisc, FallsWithHorizontalGyros) {
  const ConstantSpeed law{-5.0, 3.0, 6.0, 100.0};
  const auto fall = [&law](Mount mount) {
    const Machine machine = umbrella("prototype_b", mount);
    State start = machine.state({0.004, -0.002}, {});
    if (mount == Mount::kUniversalJoint) {
      start.q[2] = 0.004;
      start.q[3] = -0.002;
    }
    start.v[machine.layout.disc] = -5.0;
    return run(machine, start, 3.0, [&](double t, const State& state) {
      Input u;
      u.mode = model::DriveMode::kIdealTorque;
      u.drive[0] = law.torque(machine, t, state);
      return u;
    });
  };
  const Outcome rigid = fall(Mount::kRigid);
  const Outcome universal = fall(Mount::kUniversalJoint);
  EXPECT_LT(rigid.time, 1.0);                      // [s], measured 0.902
  EXPECT_LT(universal.time, 1.0);                  // [s], measured 0.902
  EXPECT_NEAR(rigid.time, universal.time, 0.001);  // [s], measured 1e-5

  const Outcome level = fall(Mount::kLevel);
  EXPECT_EQ(level.time, 3.0);
  EXPECT_LT(std::hypot(level.last.q[0], level.last.q[1]), 0.001 * kDegree);  // measured 0
}

/// The sleeping top on soft axles, disc at constant speed, pushed about x.
template <typename Push>
Outcome sleeping(double duration, const Push& moment) {
  auto p = reference::umbrella("prototype_b_sleeping");
  p.mount = Mount::kUniversalJoint;
  const Machine machine = model::build(p);
  const ConstantSpeed law{-5.0, 2.0, 4.0, 5.0};
  const State start =
      machine.state({0, 0, 0, 0, 0, p.gyros.ring_elevation - 0.01}, {0, 0, 0, 0, -5.0, 0});
  return run(machine, start, duration,
             [&](double t, const State& state) {
               Input u;
               u.mode = model::DriveMode::kIdealTorque;
               u.drive[0] = law.torque(machine, t, state);
               u.moment.x() = moment(t);
               return u;
             },
             {1e-7, 1e-9});
}

TEST(FreeDisc, SleepingTopSettlesAfterAPush) {
  const Outcome pushed =
      sleeping(20.0, [](double t) { return t > 1.0 && t < 1.02 ? 0.5 / 0.02 : 0.0; });
  EXPECT_EQ(pushed.time, 20.0);
  EXPECT_NEAR(pushed.peak_tilt / kDegree, 9.8, 0.1);                          // measured 9.75
  EXPECT_LT(std::hypot(pushed.last.q[0], pushed.last.q[1]), 0.07 * kDegree);  // measured 0.017
}

/// It leans into a constant moment until the weight carries it: M + (U - P) theta = 0, P the
/// pendulous stiffness of disc and gyros below their joint.
TEST(FreeDisc, SleepingTopLeansIntoALoad) {
  const double moment = 1.0;
  const Outcome pushed = sleeping(30.0, [=](double) { return moment; });
  const auto p = reference::umbrella("prototype_b_sleeping");
  const double S1 =
      p.disc.mass * p.disc.cm_offset + p.gyros.count * p.gyros.mass * p.gyros.pivot_height;
  const double lean = -moment / (model::reduce(p).U + S1 * model::kGravity);
  EXPECT_NEAR(pushed.last.q[0], lean, 0.002 * std::abs(lean));  // measured 0.0004
  EXPECT_NEAR(pushed.last.q[1], 0.0, 0.002 * std::abs(lean));   // measured 0.0006
}

/// Whatever the gains of a law that is linear in the state, at rest the weight must carry the load:
/// U sin(th) = -M.
TEST(Gimballed, MonorailLeansIntoALoad) {
  const auto p = reference::gimballed("brennan_monorail");
  const Machine machine = model::build(p);
  const double U = model::reduce(p).U, moment = 34e3;
  const auto law = [=](double /*t*/, const State& state) {
    Input u;
    u.mode = model::DriveMode::kIdealTorque;
    u.drive[0] =
        -(697927 * state.q[0] + 258227 * state.v[0] - 66667 * state.q[1] + 3779 * state.v[1]);
    u.moment.x() = moment;
    return u;
  };
  const Outcome pushed = run(machine, machine.state({}, {}), 60.0, law, {1e-10, 1e-12});
  EXPECT_NEAR(std::asin(moment / U), 0.0689, 5e-5);              // [rad], measured 0.06889
  EXPECT_NEAR(pushed.last.q[0], -std::asin(moment / U), 1e-10);  // [rad], measured 1.8e-13
  EXPECT_NEAR(pushed.last.v.norm(), 0.0, 1e-8);                  // [rad/s], measured 1.3e-10
}

}  // namespace
}  // namespace gyrotwin
