// Momenta: what nothing acts on stays, and what the supports supply is what is missing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bodies.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;
using model::Coordinates;
using model::Input;
using model::Machine;
using model::Motion;
using model::Mount;
using model::State;
using model::TrackKind;
using reference::Random;

constexpr Mount kMounts[] = {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint};

/// df/dt along a motion, f(State).
template <typename F>
auto rate_along(const Machine& machine, const State& state, const Input& input, const F& f) {
  const double h = 1e-4;
  const Coordinates a = machine.acceleration(state, input);
  const model::RotorSpeeds n_t = machine.rotor_acceleration(state, input);
  const auto at = [&](double t) {
    State there{state.q + t * state.v, state.v + t * a, state.rotor_speed};
    for (int j = 0; j < model::kMaxRotors; ++j) there.rotor_speed[j] += t * n_t[j];
    return f(there);
  };
  using Value = decltype(f(state));
  return Value((8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h));
}

Vector3d angular_momentum(const Machine& machine, const State& state, const Input& input = {}) {
  return machine.truth(state, input).angular_momentum;
}

/// Moment about the ground pivot, world [N m], of everything outside that the model knows: weight,
/// the support's acceleration, force and moment of the input, load cell.
Vector3d known_moment(const Machine& machine, const State& state, const Input& input) {
  Motion motion;
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d::Zero()}, motion);
  const Eigen::Matrix3d& R_S = motion.frame[0].R;
  const Vector3d weight = -Vector3d(0, 0, machine.gravity) - input.ground_acceleration;
  Vector3d moment = input.moment + (R_S * machine.push_point).cross(input.force);
  for (const MovingBody& body : moving_bodies(machine, state, {Vector3d::Zero()})) {
    moment += body.p.cross(body.mass * weight);
  }
  for (const model::PointMass& added : input.added) {
    moment += (R_S * added.position).cross(added.mass * weight);
  }
  if (machine.load_cell) {
    const double force = machine.truth(state, input).load_cell;
    moment -= (R_S * machine.load_cell->point).cross(force * machine.load_cell->direction);
  }
  return moment;
}

/// What of dL/dt is left: by the ground joint and, in mount `level`, the external support.
Vector3d missing_moment(const Machine& machine, const State& state, const Input& input) {
  const Vector3d seen_from_the_support = rate_along(
      machine, state, input, [&](const State& s) { return angular_momentum(machine, s, input); });
  const Vector3d L = angular_momentum(machine, state, input);
  return seen_from_the_support + Vector3d(0, 0, input.yaw_rate).cross(L) -
         known_moment(machine, state, input);
}

/// Weightless, with every internal force but nothing from outside, 1 s: p_thx + p_bx is the world's
/// x component of the angular momentum of everything and stays.
TEST(Momentum, AboutXStaysWeightless) {
  auto p = reference::umbrella("prototype_b");
  p.mount = Mount::kUniversalJoint;
  p.structure.damping = 0.0;  // from the ground
  p.bushing = {50.0, 3.0, 2.0};
  Machine machine = model::build(p);
  machine.gravity = 0.0;
  const State start =
      machine.state({0.02, 0.01, 0.01, -0.02, 0.1, 0.02}, {0.3, -0.2, 0.2, 0.1, -5.0, 0.1});
  Input drive;
  drive.drive[0] = -1.0;
  const auto about_x = [&machine](const State& state) {
    const Coordinates momentum = machine.generalised_momentum(state);
    return momentum[0] + momentum[2];
  };
  const double first = about_x(start);
  double worst = 0.0;
  reference::simulate(
      machine, start, 1.0, [&](double, const State&) { return drive; }, {1e-11, 1e-11},
      [&](double /*t*/, const State& state) {
        worst = std::max({worst, std::abs(about_x(state) - first),
                          std::abs(angular_momentum(machine, state).x() - first)});
        return machine.tilt(state) < 1.0;
      });
  EXPECT_LT(worst, 1e-12);  // [N m s], measured 5.5e-15
}

/// No torque on the disc: p_phi stays while the axles exchange spin with the rotors.
TEST(Momentum, DiscKeepsItsOwn) {
  for (const Mount mount : kMounts) {
    auto p = reference::frictionless(reference::umbrella("prototype_b"));
    p.mount = mount;
    p.track = TrackKind::kNone;
    Machine machine = model::build(p);
    machine.gravity = 0.0;
    const int phi = machine.layout.disc;
    State start = machine.state({0.2, -0.1, 0.1}, {0.3, 0.2, 0.0});
    start.v[phi] = -5.0;
    start.v[phi + 1] = 1.0;
    const double first = machine.generalised_momentum(start)[phi];
    double worst = 0.0, spin_change = 0.0;
    reference::simulate(machine, start, 1.0, reference::no_input, {1e-12, 1e-13},
                        [&](double /*t*/, const State& state) {
                          worst = std::max(
                              worst, std::abs(machine.generalised_momentum(state)[phi] - first));
                          spin_change = std::max(spin_change, std::abs(state.v[phi] + 5.0));
                          return true;
                        });
    EXPECT_LT(worst, 1e-11);      // [N m s], measured 3.7e-14
    EXPECT_GT(spin_change, 5.0);  // [rad/s], measured 10.1: it was not at rest
  }
}

/// The generalised momenta are components of the bodies' momenta: about world x, and of disc and
/// gyros about z_D.
TEST(Momentum, GeneralisedIsAngular) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    auto p = random.umbrella();
    p.mount = Mount::kUniversalJoint;
    const Machine machine = model::build(p);
    const State state = random.state(machine, 0.7, 3.0);
    const Coordinates momentum = machine.generalised_momentum(state);
    const Vector3d L = angular_momentum(machine, state);
    worst = std::max(worst, std::abs(momentum[0] + momentum[2] - L.x()) / L.norm());
  }
  for (int i = 0; i < 200; ++i) {
    for (const auto arrangement : {model::Arrangement::kSingle, model::Arrangement::kPair}) {
      const Machine machine = model::build(random.gimballed(arrangement));
      const State state = random.state(machine, 0.7, 3.0);
      const Vector3d L = angular_momentum(machine, state);
      worst = std::max(worst, std::abs(machine.generalised_momentum(state)[0] - L.x()) / L.norm());
    }
  }
  EXPECT_LT(worst, 1e-11);  // measured 2.7e-13
}

/// What the ground joint and, in mount `level`, the external support exert on the machine, found
/// from dL/dt with everything acting. A Hooke joint carries a moment along the normal n of its two
/// axes alone; the support's moment is horizontal. So the x and y components of what is missing
/// must be the holding moment, plus the share of the joint's moment that has a y component.
TEST(Momentum, HoldingMomentIsWhatIsMissing) {
  Random random(2);
  double worst = 0.0;
  for (int i = 0; i < 300; ++i) {
    auto p = random.umbrella();
    p.mount = Mount::kLevel;
    p.track = TrackKind::kSlot;
    Machine machine = model::build(p);
    machine.rotor_drive = random.rotor_drive();
    machine.load_cell = random.load_cell();
    const State state = random.state(machine, 0.3, 2.0);
    const Input input = random.input();
    const Vector3d missing = missing_moment(machine, state, input);

    const double sx = std::sin(state.q[0]), cx = std::cos(state.q[0]);
    const Vector3d second_axis(0.0, cx, sx), normal(0.0, -sx, cx);
    const Vector3d damping(-machine.damping[0] * state.v[0], 0.0, 0.0);
    const Vector3d damping_2 = -machine.damping[1] * state.v[1] * second_axis;
    const Vector3d rest = missing - damping - damping_2;
    const double carried = rest.z() / normal.z();
    const Vector3d holding = rest - carried * normal;

    const auto found = machine.truth(state, input).holding_moment;
    const double scale = holding.norm();
    worst = std::max({worst, std::abs(holding.x() - found[0]) / scale,
                      std::abs(holding.y() - found[1]) / scale});
  }
  EXPECT_LT(worst, 1e-11);  // measured 5.7e-14
}

/// Without a support the ground joint is alone, and what is missing lies along its normal:
/// whatever drive, contact, bushing and friction do to the disc they undo to the structure.
TEST(Momentum, OnlyTheGroundJointChangesIt) {
  Random random(3);
  double worst = 0.0;
  for (const Mount mount : {Mount::kRigid, Mount::kUniversalJoint}) {
    for (int i = 0; i < 300; ++i) {
      auto p = random.umbrella();
      p.mount = mount;
      p.track = TrackKind::kSlot;
      p.structure.damping = 0.0;
      Machine machine = model::build(p);
      machine.rotor_drive = random.rotor_drive();
      machine.load_cell = random.load_cell();
      const State state = random.state(machine, 0.3, 2.0);
      const Vector3d missing = missing_moment(machine, state, random.input());
      const Vector3d normal(0.0, -std::sin(state.q[0]), std::cos(state.q[0]));
      worst = std::max(worst, (missing - missing.dot(normal) * normal).norm() / missing.norm());
    }
  }
  EXPECT_LT(worst, 1e-9);  // measured 2.1e-11
}

}  // namespace
}  // namespace gyrotwin
