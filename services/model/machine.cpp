#include "services/model/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/model/contact.hpp"

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

// A stop's damping per stiffness [s], and the overshoot over which it comes in [rad].
constexpr double kStopDamping = 0.02;
constexpr double kStopRamp = 0.01;

double overshoot(const Stop& stop, double q) {
  return q > stop.upper ? q - stop.upper : q < stop.lower ? q - stop.lower : 0.0;
}

double stop_torque(const Stop& stop, double q, double v) {
  const double d = overshoot(stop, q);
  if (d == 0.0) return 0.0;
  const double deeper = d * v > 0.0 ? v * std::min(1.0, std::abs(d) / kStopRamp) : 0.0;
  return -stop.stiffness * (d + kStopDamping * deeper);
}

/// A moment between disc and structure, on the disc as given, on the structure opposite.
void add_pair(const Machine& machine, const Motion& motion, const Vector3d& moment,
              Coordinates& Q) {
  for (int i : machine.tree.angular(machine.disc_body)) {
    Q[i] += motion.frame[machine.disc_body].Jw[i].dot(moment);
  }
  for (int i : machine.tree.angular(0)) Q[i] -= motion.frame[0].Jw[i].dot(moment);
}

double disc_spin(const Machine& machine, const Motion& motion) {
  const Frame& disc = motion.frame[machine.disc_body];
  return (disc.omega - motion.frame[0].omega).dot(disc.R.col(2));
}

double rate_of(const Machine& machine, const Motion& motion, const Drive& drive,
               const State& state) {
  return drive.kind == Drive::Kind::kDisc ? disc_spin(machine, motion) : state.v[drive.coordinate];
}

void add_bushing(const Machine& machine, const Motion& motion, Coordinates& Q) {
  const TiltBushing& bushing = machine.bushing;
  const Frame& disc = motion.frame[machine.disc_body];
  const Frame& structure = motion.frame[0];
  const Vector3d z_D = disc.R.col(2);
  const Vector3d tilt = structure.R.col(2).cross(z_D);
  const Vector3d omega = disc.omega - structure.omega;
  const double spin = omega.dot(z_D);
  const Vector3d standing = omega - spin * z_D;                 // tilt rate seen from the structure
  const Vector3d rotating = standing - spin * z_D.cross(tilt);  // and from the spinning disc
  const Vector3d on_disc = -bushing.stiffness * tilt - bushing.rotating_damping * rotating -
                           bushing.standing_damping * standing +
                           bushing.rotating_damping * rotating.dot(z_D.cross(tilt)) * z_D;
  add_pair(machine, motion, on_disc, Q);
}

/// Everything in Q but the contact, which is the one part that needs the tips.
Coordinates applied_forces(const Machine& machine, const Motion& motion, const State& state,
                           const Input& input) {
  const int n = machine.coordinates();
  Coordinates Q = Coordinates::Zero();
  for (int i = 0; i < n; ++i) Q[i] = -machine.damping[i] * state.v[i];
  for (const Stop& stop : machine.stops) {
    Q[stop.coordinate] += stop_torque(stop, state.q[stop.coordinate], state.v[stop.coordinate]);
  }

  // External wrench on the structure.
  const Frame& structure = motion.frame[0];
  const Vector3d arm = structure.R * machine.push_point;
  const Vector3d moment = input.moment + arm.cross(input.force);
  for (int i : machine.tree.linear(0)) Q[i] += structure.Jv[i].dot(input.force);
  for (int i : machine.tree.angular(0)) Q[i] += structure.Jw[i].dot(moment);

  // Friction, bushing and drives.
  double disc_torque = 0.0;
  if (machine.disc_body != kFixed) {
    const double spin = disc_spin(machine, motion);
    disc_torque = -machine.disc_friction.viscous * spin -
                  machine.disc_friction.coulomb * std::tanh(spin / DiscFriction::kCreep);
    const TiltBushing& b = machine.bushing;
    if (b.stiffness != 0.0 || b.rotating_damping != 0.0 || b.standing_damping != 0.0) {
      add_bushing(machine, motion, Q);
    }
  }
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const Drive& drive = machine.drives[i];
    const double rate = rate_of(machine, motion, drive, state);
    const double torque = drive.torque(input.mode, input.drive[i], rate);
    if (drive.kind == Drive::Kind::kDisc) {
      disc_torque += torque;
    } else {
      Q[drive.coordinate] += torque;
    }
  }
  if (disc_torque != 0.0) {
    add_pair(machine, motion, disc_torque * motion.frame[machine.disc_body].R.col(2), Q);
  }
  return Q;
}

void evaluate(const Machine& machine, const State& state, Motion& motion) {
  machine.tree.evaluate(state.q, state.v, state.rotor_speed, machine.gravity, motion);
}

Coordinates all_forces(const Machine& machine, const Motion& motion, const State& state,
                       const Input& input) {
  Coordinates Q = applied_forces(machine, motion, state, input);
  if (machine.track) add_contact(machine, motion, Q);
  return Q;
}

/// M v with the lower triangle of M.
Coordinates times(const Motion& motion, const Coordinates& v, int n) {
  Coordinates p = Coordinates::Zero();
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) p[i] += (i >= j ? motion.M(i, j) : motion.M(j, i)) * v[j];
  }
  return p;
}

/// (M q'' - f - Q) of the free disc's two tilt coordinates, with the level disc's accelerations.
std::array<double, 2> holding_moment(const Machine& machine, const State& state,
                                     const Coordinates& acceleration, const Input& input) {
  const Machine& free = *machine.unheld;
  const auto lift = [](const Coordinates& x) {
    Coordinates y;
    y << x[0], x[1], 0.0, 0.0, x[2], x[3];
    return y;
  };
  State lifted{lift(state.q), lift(state.v), state.rotor_speed};
  Motion motion;
  evaluate(free, lifted, motion);
  const Coordinates missing = times(motion, lift(acceleration), free.coordinates()) - motion.f -
                              all_forces(free, motion, lifted, input);
  return {missing[free.layout.disc_tilt[0]], missing[free.layout.disc_tilt[1]]};
}

double potential_energy(const Machine& machine, const Motion& motion, const State& state) {
  double V = 0.0;
  const auto& bodies = machine.tree.bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    V += bodies[b].mass * machine.gravity * motion.p_cm[b].z();
  }
  for (const Stop& stop : machine.stops) {
    const double d = overshoot(stop, state.q[stop.coordinate]);
    V += 0.5 * stop.stiffness * d * d;
  }
  if (machine.disc_body != kFixed) {
    const double cos_tilt = motion.frame[0].R.col(2).dot(motion.frame[machine.disc_body].R.col(2));
    V += machine.bushing.stiffness * (1.0 - cos_tilt);
  }
  return V;
}

}  // namespace

std::array<double, 2> Drive::range(double rate) const noexcept {
  if (!motor) return {-torque_limit, torque_limit};
  const double low = motor->torque(-motor->supply_voltage, rate);
  const double high = motor->torque(motor->supply_voltage, rate);
  return {std::clamp(low, -torque_limit, torque_limit),
          std::clamp(high, -torque_limit, torque_limit)};
}

double Drive::torque(DriveMode mode, double command, double rate) const noexcept {
  if (mode == DriveMode::kIdealTorque) return command;
  double wanted = command;
  if (mode == DriveMode::kBrake) wanted = motor ? motor->torque(0.0, rate) : -command * rate;
  if (mode == DriveMode::kVoltage) {
    if (!motor) return 0.0;
    const double Vb = motor->supply_voltage;
    wanted = motor->torque(std::clamp(command, -Vb, Vb), rate);
  }
  const auto [low, high] = range(rate);
  return std::clamp(wanted, low, high);
}

State Machine::state(const std::vector<double>& q, const std::vector<double>& v) const {
  State state;
  std::copy_n(q.begin(), std::min<std::size_t>(q.size(), coordinates()), state.q.begin());
  std::copy_n(v.begin(), std::min<std::size_t>(v.size(), coordinates()), state.v.begin());
  state.rotor_speed = nominal_rotor_speed;
  return state;
}

Coordinates Machine::acceleration(const State& state, const Input& input) const noexcept {
  Motion motion;
  evaluate(*this, state, motion);
  return solve(motion.M, motion.f + all_forces(*this, motion, state, input), coordinates());
}

double Machine::drive_rate(int drive, const State& state) const noexcept {
  Motion motion;
  evaluate(*this, state, motion);
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
  evaluate(*this, state, motion);

  truth.kinetic_energy = 0.5 * state.v.dot(times(motion, state.v, coordinates()));
  truth.potential_energy = potential_energy(*this, motion, state);
  const auto& bodies = tree.bodies();
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const Frame& frame = motion.frame[b];
    const Vector3d spin = bodies[b].inertia.cwiseProduct(frame.R.transpose() * frame.omega);
    truth.angular_momentum +=
        bodies[b].mass * motion.p_cm[b].cross(motion.v_cm[b]) + frame.R * (spin + motion.h[b]);
    if (!track || bodies[b].rotor_index < 0) continue;
    const TipMotion tip = tip_motion(*track, motion, b);
    const Indentation lower = lower_indentation(*track, motion, tip);
    const Indentation upper = upper_indentation(*track, motion, tip);
    truth.contact_lower[bodies[b].rotor_index] = normal_force(*track, lower);
    truth.contact_upper[bodies[b].rotor_index] = normal_force(*track, upper);
    truth.potential_energy += contact_energy(*track, lower) + contact_energy(*track, upper);
  }

  if (unheld) {
    const Coordinates Q = all_forces(*this, motion, state, input);
    truth.holding_moment =
        holding_moment(*this, state, solve(motion.M, motion.f + Q, coordinates()), input);
  }
  truth.gimbal_margin = std::numeric_limits<double>::infinity();
  for (const Stop& stop : stops) {
    const double q = state.q[stop.coordinate];
    truth.gimbal_margin = std::min({truth.gimbal_margin, stop.upper - q, q - stop.lower});
  }
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const double rate = rate_of(*this, motion, drives[i], state);
    const double torque = drives[i].torque(input.mode, input.drive[i], rate);
    const auto [low, high] = drives[i].range(rate);
    truth.drive_torque[i] = torque;
    truth.drive_margin[i] = torque >= 0.0 ? high - torque : torque - low;
  }
  return truth;
}

Coordinates Machine::generalised_momentum(const State& state) const noexcept {
  Motion motion;
  evaluate(*this, state, motion);
  Coordinates p = times(motion, state.v, coordinates());
  for (int b = 0; b < static_cast<int>(tree.bodies().size()); ++b) {
    const Vector3d h = motion.frame[b].R * motion.h[b];
    for (int i : tree.angular(b)) p[i] += motion.frame[b].Jw[i].dot(h);
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
