// Energy: kept without friction, lost through it, and moved by nothing but the powers that act.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/model/contact.hpp"
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

double energy(const Machine& machine, const State& state) {
  const model::Truth truth = machine.truth(state, {});
  return truth.kinetic_energy + truth.potential_energy;
}

/// Largest change of the energy over 10 s, relative to the kinetic energy at the start.
double drift(const Machine& machine, const State& start) {
  const double E0 = energy(machine, start);
  const double T0 = machine.truth(start, {}).kinetic_energy;
  double worst = 0.0;
  reference::simulate(machine, start, 10.0, reference::no_input, {1e-13, 1e-13},
                      [&](double /*t*/, const State& state) {
                        worst = std::max(worst, std::abs(energy(machine, state) - E0));
                        return true;
                      });
  return worst / T0;
}

Machine free_umbrella(const std::string& set, Mount mount, double gravity) {
  auto p = reference::frictionless(reference::umbrella(set));
  p.mount = mount;
  p.track = TrackKind::kNone;
  p.gyros.stop_lower = -10.0;  // a stop's damping takes energy
  p.gyros.stop_upper = 10.0;
  Machine machine = model::build(p);
  machine.gravity = gravity;
  return machine;
}

/// Upward gravity is a machine that hangs: it swings without end and stays away from |thy| = 90
/// deg.
TEST(Energy, UmbrellaKeepsItHanging) {
  for (const Mount mount : kMounts) {
    const Machine machine = free_umbrella("prototype_b", mount, -model::kGravity);
    const State start =
        mount == Mount::kUniversalJoint
            ? machine.state({0.3, -0.2, 0.1, 0.2, 0.1, 0.2}, {0.5, 0.4, 0.2, 0.3, -3.0, 0.3})
            : machine.state({0.3, -0.2, 0.1, 0.2}, {0.5, 0.4, -3.0, 0.3});
    EXPECT_LT(drift(machine, start), 1e-10);  // measured 7.9e-12
  }
}

TEST(Energy, UmbrellaKeepsItWeightless) {
  for (const Mount mount : kMounts) {
    const Machine machine = free_umbrella("townsend", mount, 0.0);
    const State start =
        mount == Mount::kUniversalJoint
            ? machine.state({0.1, -0.1, 0.1, 0.1, 0.1, 0.2}, {0.05, 0.02, 0.1, 0.1, -1.0, 0.3})
            : machine.state({0.1, -0.1, 0.1, 0.2}, {0.05, 0.02, -1.0, 0.3});
    EXPECT_LT(drift(machine, start), 1e-10);  // measured 8.1e-12
  }
}

TEST(Energy, GimballedKeepsItHanging) {
  for (const char* set : {"brennan_monorail", "gyrocar", "double_brennan"}) {
    auto p = reference::frictionless(reference::gimballed(set));
    p.gyros.stop = 10.0;
    Machine machine = model::build(p);
    machine.gravity = -model::kGravity;
    const State start = machine.coordinates() == 4
                            ? machine.state({0.2, -0.1, 0.1, 0.2}, {0.1, 0.2, 0.3, -0.2})
                            : machine.state({0.2, 0.1}, {0.1, 0.3});
    EXPECT_LT(drift(machine, start), 1e-10);  // measured 2.2e-11
  }
}

/// The sleeping preset on its soft lossy ring with the drive off: contact, stops and friction take
/// energy and nothing gives any.
TEST(Energy, ContactAndFrictionOnlyTakeIt) {
  auto p = reference::umbrella("prototype_b_sleeping");
  p.mount = Mount::kUniversalJoint;
  const Machine machine = model::build(p);
  const State start = machine.state({0.03, -0.01, 0.03, -0.01, 0.0, p.gyros.ring_elevation},
                                    {0.0, 0.0, 0.0, 0.0, -5.0, 0.0});
  double before = energy(machine, start);
  const double first = before;
  double largest_gain = 0.0;
  reference::simulate(machine, start, 3.0, reference::no_input, {1e-11, 1e-12},
                      [&](double /*t*/, const State& state) {
                        const double now = energy(machine, state);
                        largest_gain = std::max(largest_gain, now - before);
                        before = now;
                        return machine.tilt(state) < 0.7;
                      });
  EXPECT_LT(largest_gain, 1e-10);  // [J], measured 0
  EXPECT_GT(first - before, 2.0);  // [J], measured 3.0
}

/// T0, the part of the kinetic energy that the support's turning gives even to coordinates at rest,
/// rotors' momentum included.
double turning_energy(const Machine& machine, const State& state, const Input& input) {
  const State at_rest{state.q, Coordinates::Zero(), state.rotor_speed};
  const model::Support turning{Vector3d::Zero(), input.yaw_rate};
  double T0 = 0.0;
  for (const MovingBody& body : moving_bodies(machine, at_rest, turning)) {
    const Vector3d w = body.omega;
    T0 += 0.5 * body.mass * body.v.squaredNorm() + 0.5 * w.dot(body.inertia * w);
    if (body.rotor_index >= 0) T0 += state.rotor_speed[body.rotor_index] * w.dot(body.rotor_axis);
  }
  Motion motion;
  machine.tree.evaluate(at_rest.q, at_rest.v, {at_rest.rotor_speed}, turning, motion);
  for (const model::PointMass& added : input.added) {
    const Vector3d p = motion.frame[0].R * added.position;
    T0 += 0.5 * added.mass * Vector3d(0, 0, input.yaw_rate).cross(p).squaredNorm();
  }
  return T0;
}

/// d/dt (T2 - T0 + V) by differences along the motion.
double energy_rate(const Machine& machine, const State& state, const Input& input) {
  const Coordinates a = machine.acceleration(state, input);
  const model::RotorSpeeds n_t = machine.rotor_acceleration(state, input);
  const double h = 1e-5;  // short: a tip may just touch
  const auto at = [&](double t) {
    State there{state.q + t * state.v, state.v + t * a, state.rotor_speed};
    for (int j = 0; j < model::kMaxRotors; ++j) there.rotor_speed[j] += t * n_t[j];
    const model::Truth truth = machine.truth(there, input);
    return truth.kinetic_energy + truth.potential_energy - turning_energy(machine, there, input);
  };
  return (8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h);
}

/// Powers, seen from the support, of everything that is not in that energy [W].
std::vector<double> powers(const Machine& machine, const State& state, const Input& input) {
  Motion motion;
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d::Zero()}, motion);
  const Eigen::Matrix3d& R_S = motion.frame[0].R;
  const Vector3d omega_S = R_S * motion.frame[0].omega;
  const auto velocity = [&](const Vector3d& position) {
    return Vector3d(omega_S.cross(R_S * position));
  };
  std::vector<double> P{input.force.dot(velocity(machine.push_point)), input.moment.dot(omega_S)};
  for (int i = 0; i < machine.coordinates(); ++i) {
    P.push_back(-machine.damping[i] * state.v[i] * state.v[i]);
  }
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    P.push_back(input.drive_strength[i] * input.drive[i] *
                machine.drive_rate(static_cast<int>(i), state));
  }

  // The support's acceleration on all masses; rotors' run-up against their frames; the load cell.
  const model::RotorSpeeds n_t = machine.rotor_acceleration(state, input);
  for (const MovingBody& body : moving_bodies(machine, state, {Vector3d::Zero()})) {
    P.push_back(-body.mass * input.ground_acceleration.dot(body.v));
    if (body.rotor_index < 0) continue;
    const Vector3d omega = body.omega + Vector3d(0, 0, input.yaw_rate);
    P.push_back(-n_t[body.rotor_index] * omega.dot(body.rotor_axis));
  }
  for (const model::PointMass& added : input.added) {
    P.push_back(-added.mass * input.ground_acceleration.dot(velocity(added.position)));
  }
  if (machine.load_cell) {
    const double rate = machine.load_cell->direction.dot(velocity(machine.load_cell->point));
    P.push_back(-machine.load_cell->damping * rate * rate);
  }
  if (machine.disc_body == model::kFixed) return P;

  const auto& D = motion.frame[machine.disc_body];
  const Vector3d z_D = D.R.col(2), z_S = R_S.col(2);
  const Vector3d w = D.R * D.omega - omega_S;
  const double spin = w.dot(z_D);
  P.push_back(-machine.disc_friction.viscous * spin * spin);
  P.push_back(-machine.disc_friction.coulomb * std::tanh(spin / 0.05) * spin);

  // Tilt rates as the structure and as the spinning disc see them.
  const Vector3d ad = w - spin * z_D;
  const Vector3d e = ad - spin * z_D.cross(z_S.cross(z_D));
  P.push_back(-machine.bushing.rotating_damping * e.squaredNorm());
  P.push_back(-machine.bushing.standing_damping * ad.squaredNorm());

  // Contact: what the normal force takes beyond the spring, and the rolling drag.
  if (!machine.track) return P;
  const model::Track& track = *machine.track;
  const auto disc = model::disc_motion(machine, motion);
  const auto tips = model::tips_of(machine, disc, motion, state);
  for (int j = 0; j < machine.rotors; ++j) {
    const Vector3d v_rel = D.R * tips.v_rel.row(j).matrix().transpose();
    const Vector3d v_t = v_rel - z_S.dot(v_rel) * z_S;
    for (const auto& in : {tips.lower, tips.upper}) {
      const double depth = in.depth[j];
      if (depth <= 0.0) continue;
      const double force = model::normal_force(track, in)[j];
      P.push_back(-(force - track.stiffness * std::pow(depth, 1.5)) * in.rate[j]);
      P.push_back(-track.rolling_drag * force * v_t.squaredNorm() /
                  std::sqrt(v_t.squaredNorm() + 1e-4));
    }
  }
  return P;
}

double imbalance(Random& random, Machine machine, double angle, double rate) {
  machine.rotor_drive = random.rotor_drive();
  machine.load_cell = random.load_cell();
  const State state = random.state(machine, angle, rate);
  const Input input = random.input();
  double sum = 0.0, scale = 0.0;
  for (double P : powers(machine, state, input)) {
    sum += P;
    scale += std::abs(P);
  }
  const double dE_dt = energy_rate(machine, state, input);
  return std::abs(dE_dt - sum) / scale;
}

TEST(Energy, RateIsTheSumOfPowersInUmbrellas) {
  Random random(7);  // of few others a tip touches within the differences: up to 5e-5
  double worst = 0.0;
  for (const Mount mount : kMounts) {
    for (int i = 0; i < 200; ++i) {
      auto p = random.umbrella();
      p.mount = mount;
      p.track = TrackKind::kSlot;
      p.bushing = mount == Mount::kUniversalJoint ? p.bushing : model::TiltBushing{};
      worst = std::max(worst, imbalance(random, model::build(p), 0.3, 2.0));
    }
  }
  EXPECT_LT(worst, 1e-7);  // measured 3.0e-9, of the differences
}

TEST(Energy, RateIsTheSumOfPowersInGyroscopes) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    worst = std::max(worst, imbalance(random, model::build(random.gyroscope()), 0.7, 2.0));
  }
  EXPECT_LT(worst, 1e-6);  // measured 4.1e-8, of the differences
}

TEST(Energy, RateIsTheSumOfPowersInGimballedMachines) {
  Random random(2);
  double worst = 0.0;
  for (const auto arrangement :
       {model::Arrangement::kSingle, model::Arrangement::kPair, model::Arrangement::kTwoPairs}) {
    for (int i = 0; i < 200; ++i) {
      const Machine machine = model::build(random.gimballed(arrangement));
      worst = std::max(worst, imbalance(random, machine, 0.5, 2.0));
    }
  }
  EXPECT_LT(worst, 1e-7);  // measured 8.3e-9, of the differences
}

}  // namespace
}  // namespace gyrotwin
