#include "services/mirror/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "services/mirror/calm_damping.hpp"
#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"

namespace gyrotwin {

using model::Coordinates;
using model::Motion;
using model::State;

namespace {

// Half the owner's steps are enough: what they miss is small beside a gyro's noise.
int substeps_of(const Rig& rig) { return std::max(2, (rig.loop.substeps + 1) / 2); }

}  // namespace

Prediction::Prediction(const Rig& rig, const model::Machine& machine, const Unknowns& unknowns)
    : machine_(machine),
      unknowns_(unknowns),
      tick_s_(rig.loop.tick_s()),
      substeps_(substeps_of(rig)),
      coulomb_(machine.disc_friction.coulomb),
      to_imu_(rig.sensors->imu_axes().transpose()),
      imu_position_(rig.sensors->imu_position),
      lightness_(lightness(machine, rig.initial_state(machine))) {}

/// Takes over what a point says of moment, friction, inertia and drives.
void Prediction::set(const Tick& tick, const Point& x) noexcept {
  input_ = tick.acting;
  for (int i = 0; i < 2; ++i) {
    if (unknowns_.moment[i] >= 0) moment_[i] = x[unknowns_.moment[i]];
  }
  if (unknowns_.friction >= 0) machine_.disc_friction.coulomb = coulomb_ + x[unknowns_.friction];
  if (unknowns_.inertia >= 0) inertia_ = unknowns_.structure_inertia * x[unknowns_.inertia];
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    if (unknowns_.strength[i] >= 0) input_.drive_strength[i] = 1.0 - x[unknowns_.strength[i]];
  }
}

/// Steps bear no brake that holds hard: it takes longer to come to where it creeps as it should.
void Prediction::calm_down(const Motion& motion, const State& state,
                           Coordinates& acceleration) const noexcept {
  const double substep = tick_s_ / substeps_;
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    const model::Drive& drive = machine_.drives[i];
    if (drive.motor) continue;  // its brake is soft
    const double rate = model::rate_of(machine_, motion, drive, state);
    const double torque = drive.torque(input_.mode, input_.drive[i], rate);
    acceleration[drive.coordinate] *= calm_share(lightness_[i], torque, rate, substep);
  }
}

/// q'' with the point's inertia on the tilt coordinates; its products of rates are left out. The
/// unknown moment is reckoned for the model's inertia: that it does little says nothing of inertia.
Coordinates Prediction::accelerate(const State& state, const model::RotorSpeeds& rotor_rate,
                                   Motion& motion) noexcept {
  model::evaluate(machine_, state, input_, rotor_rate, motion);
  for (int i = 0; i < 2; ++i) {
    const int tilt = machine_.layout.tilt[i];
    if (tilt == model::kFixed) continue;
    const double modelled = motion.M(tilt, tilt);
    motion.M(tilt, tilt) += inertia_;
    input_.moment[i] = moment_[i] * motion.M(tilt, tilt) / modelled;
  }
  model::add_forces(machine_, motion, state, input_, motion.f);
  Coordinates acceleration = machine_.tree.solve(motion.M, motion.f);
  if (input_.mode == model::DriveMode::kBrake) calm_down(motion, state, acceleration);
  return acceleration;
}

void Prediction::advance(const Tick& tick, Point& x) noexcept {
  set(tick, x);
  const int n = unknowns_.coordinates;
  State s;
  s.q.head(n) = x.head(n);
  s.v.head(n) = x.segment(n, n);
  s.rotor_speed = tick.rotor_speed;
  const double h = tick_s_ / substeps_;
  Motion motion;
  for (int k = 0; k < substeps_; ++k) {
    // Runge and Kutta's fourth order.
    State at = s;
    const Coordinates a1 = accelerate(at, tick.rotor_rate, motion);
    at.q = s.q + h / 2 * s.v;
    at.v = s.v + h / 2 * a1;
    const Coordinates v2 = at.v, a2 = accelerate(at, tick.rotor_rate, motion);
    at.q = s.q + h / 2 * v2;
    at.v = s.v + h / 2 * a2;
    const Coordinates v3 = at.v, a3 = accelerate(at, tick.rotor_rate, motion);
    at.q = s.q + h * v3;
    at.v = s.v + h * a3;
    const Coordinates v4 = at.v, a4 = accelerate(at, tick.rotor_rate, motion);
    s.q += h / 6 * (s.v + 2 * v2 + 2 * v3 + v4);
    s.v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  x.head(n) = s.q.head(n);
  x.segment(n, n) = s.v.head(n);
}

void Prediction::sense(const Tick& tick, const Point& x, Channels& expected) noexcept {
  set(tick, x);
  const int n = unknowns_.coordinates;
  State s;
  s.q.head(n) = x.head(n);
  s.v.head(n) = x.segment(n, n);
  s.rotor_speed = tick.rotor_speed;
  Motion motion;
  const Coordinates acceleration = accelerate(s, tick.rotor_rate, motion);

  // The IMU, as Machine::inertial() has it.
  const auto imu = model::structure_point(machine_, motion, imu_position_);
  Eigen::Vector3d a = imu.a0;
  for (int i = 0; i < n; ++i) a += imu.J[i] * acceleration[i];
  const Eigen::Vector3d omega = to_imu_ * motion.frame[0].omega;
  const Eigen::Vector3d force = to_imu_ * a;

  int next = 0;
  for (int i = 0; i < 3; ++i) expected[next++] = omega[i];
  for (int i = 0; i < 3; ++i) expected[next++] = force[i];
  if (machine_.layout.disc != model::kFixed) expected[next++] = s.q[machine_.layout.disc];
  for (const auto& [coordinate, coefficient] : machine_.layout.gimbals) {
    expected[next++] = coefficient * s.q[coordinate];
  }
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    const model::Drive& drive = machine_.drives[i];
    if (!drive.motor) continue;
    const double rate = model::rate_of(machine_, motion, drive, s);
    const double torque = drive.torque(input_.mode, input_.drive[i], rate);
    expected[next++] = input_.drive_strength[i] * torque /
                       (drive.motor->torque_constant * drive.motor->gear_ratio);
  }
  if (machine_.load_cell) expected[next++] = model::load_cell_force(machine_, motion, input_);
}

}  // namespace gyrotwin
