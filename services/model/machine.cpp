#include "services/model/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/model/contact.hpp"
#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

/// The machine alone, on a support at rest.
void evaluate(const Machine& machine, const State& state, Motion& motion) {
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, support_of(machine, {}), motion);
}

/// M v with the lower triangle of M.
Coordinates times(const Motion& motion, const Coordinates& v, int n) {
  Coordinates p = Coordinates::Zero();
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) p[i] += (i >= j ? motion.M(i, j) : motion.M(j, i)) * v[j];
  }
  return p;
}

/// What holds the disc of a level machine: what the free disc's equations about x and y lack; else
/// 0. README.md, section 6.
/// @param motion filled, of a level machine with f + Q in place of f
std::array<double, 2> holding_moment(const Machine& machine, const State& state, const Input& input,
                                     Motion& motion) {
  if (!machine.unheld) {
    evaluate(machine, state, input, {}, motion);
    return {};
  }
  const RotorSpeeds rotor_rate = machine.rotor_acceleration(state, input);
  evaluate(machine, state, input, rotor_rate, motion);
  const Vector3d on_disc = add_forces(machine, motion, state, input, motion.f);
  const Coordinates acceleration = machine.tree.solve(motion.M, motion.f);

  // The free disc's coordinates are thx, thy, bx, by, phi, tg.
  const auto lift = [](const Coordinates& x) {
    Coordinates y;
    y << x[0], x[1], 0.0, 0.0, x[2], x[3];
    return y;
  };
  const Tree& tree = *machine.unheld;
  Motion free;
  tree.evaluate(lift(state.q), lift(state.v), {state.rotor_speed, rotor_rate},
                support_of(machine, input), free);
  const Coordinates lacking = times(free, lift(acceleration), tree.coordinates()) - free.f;
  const auto& Jw = free.frame[machine.disc_body].Jw;
  return {lacking[2] - Jw[2].dot(on_disc), lacking[3] - Jw[3].dot(on_disc)};
}

/// @param motion evaluated where the machine has a disc; else it is not read
void add_drives(const Machine& machine, const Motion& motion, const State& state,
                const Input& input, Effort& effort) {
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const Drive& drive = machine.drives[i];
    const double rate = rate_of(machine, motion, drive, state);
    const double torque = drive.torque(input.mode, input.drive[i], rate);
    const auto [low, high] = drive.range(rate);
    const double margin = torque >= 0.0 ? high - torque : torque - low;
    effort.drive_torque[i] = input.drive_strength[i] * torque;
    effort.drive_margin[i] = input.drive_strength[i] * margin;
  }
}

void add_contact_forces(const Machine& machine, const Motion& motion, const State& state,
                        Truth& truth) {
  const auto tips = tips_of(machine, disc_motion(machine, motion), motion, state);
  const PerGyro<double> lower = normal_force(*machine.track, tips.lower);
  const PerGyro<double> upper = normal_force(*machine.track, tips.upper);
  const auto& gyros = machine.tree.gimbals()[0].gyros();
  for (std::size_t j = 0; j < gyros.size(); ++j) {
    truth.contact_lower[gyros[j].rotor_index] = lower[j];
    truth.contact_upper[gyros[j].rotor_index] = upper[j];
  }
}

/// Energy in the gravity field of everything, and angular momentum about the ground pivot.
void add_bodies(const Machine& machine, const Motion& motion, const State& state,
                const Input& input, Truth& truth) {
  const Tree& tree = machine.tree;
  for (int b = 0; b < tree.shape().bodies.size; ++b) {
    // The pivot and its velocity: the ground's, or one that the structure carries.
    const Frame& frame = motion.frame[b];
    Vector3d p = Vector3d::Zero();
    if (tree.shape().bodies[b].position_parent != kGround) {
      p = motion.frame[0].R * tree.bodies()[b].pivot;
    }
    Vector3d v = frame.R.transpose() * Vector3d(0.0, 0.0, input.yaw_rate).cross(p);
    for (int i : tree.linear(b)) v += frame.Jv[i] * state.v[i];

    const auto& momenta = motion.momenta[b];
    const Vector3d& first = momenta.first_moment;
    const Vector3d momentum = tree.mass(b) * v + frame.omega.cross(first) + momenta.swing;
    truth.potential_energy += machine.gravity * (tree.mass(b) * p + frame.R * first).z();
    truth.angular_momentum +=
        p.cross(frame.R * momentum) + frame.R * (first.cross(v) + momenta.angular);
  }
  for (const PointMass& added : input.added) {
    const StructurePoint<double> point = structure_point(machine, motion, added.position);
    truth.potential_energy += added.mass * machine.gravity * point.p.z();
    truth.angular_momentum += added.mass * point.p.cross(motion.frame[0].R * point.v);
  }
}

}  // namespace

double RotorDrive::torque(double wanted, double speed) const noexcept {
  const double fast = std::abs(speed), size = std::abs(wanted);
  if (size <= torque_limit && size * fast <= power_limit) return wanted;  // without a division
  const double limit = torque_limit * fast > power_limit ? power_limit / fast : torque_limit;
  return std::clamp(wanted, -limit, limit);
}

State Machine::state(const std::vector<double>& q, const std::vector<double>& v) const {
  State state;
  std::copy_n(q.begin(), std::min<std::size_t>(q.size(), coordinates()), state.q.begin());
  std::copy_n(v.begin(), std::min<std::size_t>(v.size(), coordinates()), state.v.begin());
  state.rotor_speed = nominal_rotor_speed;
  return state;
}

Coordinates Machine::acceleration(const State& state, const Input& input,
                                  const RotorSpeeds& rotor_rate) const noexcept {
  Motion motion;
  return accelerate(*this, state, input, rotor_rate, motion);
}

RotorSpeeds Machine::rotor_acceleration(const State& state, const Input& input) const noexcept {
  RotorSpeeds rate{};
  if (!rotor_drive) return rate;
  for (int j = 0; j < rotors; ++j) {
    const double Ia = tree.rotor_inertia(j);
    const double n = state.rotor_speed[j];
    const double drag = rotor_drive->drag(n);
    const double wanted = Ia * (nominal_rotor_speed[j] - n) / rotor_drive->time_constant + drag;
    const double torque = input.rotor_powered[j] ? rotor_drive->torque(wanted, n) : 0.0;
    const double brake = input.rotor_brake[j] * RotorDrive::sense(n);
    rate[j] = (torque - drag - brake) / Ia;
  }
  return rate;
}

InertialReading Machine::inertial(const State& state, const Input& input,
                                  const Vector3d& point) const noexcept {
  Motion motion;
  const Coordinates acceleration =
      accelerate(*this, state, input, rotor_acceleration(state, input), motion);
  const StructurePoint<double> imu = structure_point(*this, motion, point);
  Vector3d a = imu.a0;
  for (int i = 0; i < coordinates(); ++i) a += imu.J[i] * acceleration[i];
  return {motion.frame[0].omega, a};
}

double Machine::drive_rate(int drive, const State& state) const noexcept {
  Motion motion;
  if (drives[drive].kind == Drive::Kind::kDisc) evaluate(*this, state, motion);
  return rate_of(*this, motion, drives[drive], state);
}

Observation Machine::observe(const State& state) const noexcept {
  Observation seen;
  for (int i = 0; i < 2; ++i) {
    if (layout.tilt[i] != kFixed) {
      seen.tilt[i] = state.q[layout.tilt[i]];
      seen.tilt_rate[i] = state.v[layout.tilt[i]];
    }
    const int disc_tilt = layout.disc_follows_structure ? layout.tilt[i] : layout.disc_tilt[i];
    if (disc_tilt != kFixed) {
      seen.disc_tilt[i] = state.q[disc_tilt];
      seen.disc_tilt_rate[i] = state.v[disc_tilt];
    }
  }
  if (layout.disc != kFixed) {
    seen.disc_angle = state.q[layout.disc];
    seen.disc_rate = state.v[layout.disc];
  }
  for (std::size_t j = 0; j < layout.gimbals.size(); ++j) {
    const Layout::Gimbal& gimbal = layout.gimbals[j];
    seen.gimbal_angle[j] = gimbal.coefficient * state.q[gimbal.coordinate];
    seen.gimbal_rate[j] = gimbal.coefficient * state.v[gimbal.coordinate];
  }
  seen.rotor_speed = state.rotor_speed;
  return seen;
}

State Machine::recall(const Observation& observation) const noexcept {
  State state;
  const auto set = [&state](int coordinate, double q, double v) {
    if (coordinate == kFixed) return;
    state.q[coordinate] = q;
    state.v[coordinate] = v;
  };
  for (int i = 0; i < 2; ++i) {
    set(layout.tilt[i], observation.tilt[i], observation.tilt_rate[i]);
    set(layout.disc_tilt[i], observation.disc_tilt[i], observation.disc_tilt_rate[i]);
  }
  set(layout.disc, observation.disc_angle, observation.disc_rate);
  for (std::size_t j = 0; j < layout.gimbals.size(); ++j) {
    const Layout::Gimbal& gimbal = layout.gimbals[j];
    set(gimbal.coordinate, observation.gimbal_angle[j] / gimbal.coefficient,
        observation.gimbal_rate[j] / gimbal.coefficient);
  }
  state.rotor_speed = observation.rotor_speed;
  return state;
}

Truth Machine::truth(const State& state, const Input& input) const noexcept {
  Truth truth;
  Motion motion;
  truth.holding_moment = holding_moment(*this, state, input, motion);
  add_drives(*this, motion, state, input, truth);

  truth.kinetic_energy = 0.5 * state.v.dot(times(motion, state.v, coordinates()));
  add_bodies(*this, motion, state, input, truth);
  truth.potential_energy += spring_energy(*this, motion, state);
  truth.load_cell = load_cell_force(*this, motion, input);
  if (track) add_contact_forces(*this, motion, state, truth);
  truth.gimbal_margin = gimbal_margin(state);
  return truth;
}

Effort Machine::effort(const State& state, const Input& input) const noexcept {
  Effort effort;
  Motion motion;
  if (disc_body != kFixed) effort.holding_moment = holding_moment(*this, state, input, motion);
  add_drives(*this, motion, state, input, effort);
  return effort;
}

double Machine::gimbal_margin(const State& state) const noexcept {
  double margin = std::numeric_limits<double>::infinity();
  for (const Stop& stop : stops) {
    const double q = state.q[stop.coordinate];
    margin = std::min({margin, stop.upper - q, q - stop.lower});
  }
  return margin;
}

Coordinates Machine::generalised_momentum(const State& state) const noexcept {
  Motion motion;
  evaluate(*this, state, motion);
  Coordinates p = times(motion, state.v, coordinates());
  for (int b = 0; b < static_cast<int>(tree.bodies().size()); ++b) {
    for (int i : tree.angular(b)) p[i] += motion.frame[b].Jw[i].dot(motion.momenta[b].rotors);
  }
  return p;
}

double Machine::tilt(const State& state) const noexcept {
  double cosine = 1.0;
  for (int i : layout.tilt) {
    if (i != kFixed) cosine *= std::cos(state.q[i]);
  }
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

}  // namespace gyrotwin::model
