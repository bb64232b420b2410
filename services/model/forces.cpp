#include "services/model/forces.hpp"

#include <algorithm>
#include <cmath>

#include "services/model/contact.hpp"

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

// A stop's damping per stiffness [s], and the overshoot over which it comes in [rad].
constexpr double kStopDamping = 0.02;
constexpr double kStopRamp = 0.01;

template <class S>
S overshoot(const Stop& stop, const S& q) {
  return q > stop.upper ? S(q - stop.upper) : q < stop.lower ? S(q - stop.lower) : S(0.0);
}

template <class S>
S stop_torque(const Stop& stop, const S& q, const S& v) {
  using std::abs, std::min;
  const S d = overshoot(stop, q);
  if (d == 0.0) return S(0.0);
  const S deeper = d * v > 0.0 ? S(v * min(S(1.0), S(abs(d) / kStopRamp))) : S(0.0);
  return -stop.stiffness * (d + kStopDamping * deeper);
}

/// A moment between disc and structure: on the disc as given, in its axes, on the structure
/// opposite.
template <class S>
void add_pair(const Machine& machine, const DiscMotionOf<S>& disc, const MotionOf<S>& motion,
              const Vector3<S>& moment, CoordinatesOf<S>& Q) {
  for (int i : machine.tree.angular(machine.disc_body)) {
    Q[i] += motion.frame[machine.disc_body].Jw[i].dot(moment);
  }
  const Vector3<S> on_structure = disc.R * moment;
  for (int i : machine.tree.angular(0)) Q[i] -= motion.frame[0].Jw[i].dot(on_structure);
}

/// Moment of the bushing on the disc, disc axes.
template <class S>
Vector3<S> bushing_moment(const TiltBushing& bushing, const DiscMotionOf<S>& disc) {
  const Vector3<S> z_D = Vector3<S>::UnitZ();
  const Vector3<S> z_S = disc.R.row(2).transpose();
  const Vector3<S> tilt = z_S.cross(z_D);
  const S spin = disc.omega.z();
  const Vector3<S> standing = disc.omega - spin * z_D;  // tilt rate seen from the structure
  const Vector3<S> rotating = standing - spin * z_D.cross(tilt);  // and from the spinning disc
  return -bushing.stiffness * tilt - bushing.rotating_damping * rotating -
         bushing.standing_damping * standing +
         bushing.rotating_damping * rotating.dot(z_D.cross(tilt)) * z_D;
}

template <class S>
S disc_friction(const Machine& machine, const S& spin) {
  using std::tanh;
  return -machine.disc_friction.viscous * spin -
         machine.disc_friction.coulomb * tanh(spin / DiscFriction::kCreep);
}

/// How far the structure has moved into the load cell [m].
template <class S>
S compression(const LoadCell& cell, const StructurePoint<S>& point) {
  return cell.direction.dot(point.p - cell.point) - cell.rest;
}

template <class S>
S load_cell_force(const LoadCell& cell, const StructurePoint<S>& point, const Vector3<S>& direction,
                  double yaw_rate) {
  const S carried = Vector3d(0.0, 0.0, yaw_rate).cross(cell.direction).dot(point.p);
  return cell.stiffness * compression(cell, point) +
         cell.damping * (direction.dot(point.v) + carried);
}

/// All that disc and structure do to each other. @return as add_forces()
template <class S>
Vector3<S> add_disc_forces(const Machine& machine, const MotionOf<S>& motion,
                           const StateOf<S>& state, const Input& input, CoordinatesOf<S>& Q) {
  const DiscMotionOf<S> disc = disc_motion(machine, motion);
  const S spin = disc.omega.z();
  S along_axis = disc_friction(machine, spin);
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const Drive& drive = machine.drives[i];
    if (drive.kind != Drive::Kind::kDisc) continue;
    along_axis += input.drive_strength[i] * drive.torque(input.mode, input.drive[i], spin);
  }
  Vector3<S> moment = along_axis * Vector3<S>::UnitZ();
  if (machine.track) moment += add_contact(machine, disc, motion, state, Q);
  const TiltBushing& b = machine.bushing;
  if (b.stiffness != 0.0 || b.rotating_damping != 0.0 || b.standing_damping != 0.0) {
    moment += bushing_moment(b, disc);
  }
  add_pair(machine, disc, motion, moment, Q);
  return moment;
}

}  // namespace

template <class S>
StructurePoint<S> structure_point(const Machine& machine, const MotionOf<S>& motion,
                                  const Vector3d& position) noexcept {
  const FrameOf<S>& structure = motion.frame[0];
  const Vector3<S>& arm = position.cast<S>();
  const Vector3<S> v_arm = structure.omega.cross(arm);
  StructurePoint<S> point;
  point.p = structure.R * arm;
  point.v = v_arm;
  point.a0 = structure.a0 + structure.alpha0.cross(arm) + structure.omega.cross(v_arm);
  point.J.fill(Vector3<S>::Zero());
  for (int i : machine.tree.angular(0)) point.J[i] = structure.Jw[i].cross(arm);
  return point;
}

template <class S>
S rate_of(const Machine& machine, const MotionOf<S>& motion, const Drive& drive,
          const StateOf<S>& state) noexcept {
  return drive.kind == Drive::Kind::kDisc ? disc_motion(machine, motion).omega.z()
                                          : state.v[drive.coordinate];
}

Coordinates drive_direction(const Machine& machine, const Motion& motion,
                            const Drive& drive) noexcept {
  Coordinates Q = Coordinates::Zero();
  if (drive.kind == Drive::Kind::kDisc) {
    add_pair<double>(machine, disc_motion(machine, motion), motion, Vector3d::UnitZ(), Q);
  } else {
    Q[drive.coordinate] = 1.0;
  }
  return Q;
}

double load_cell_force(const Machine& machine, const Motion& motion, const Input& input) noexcept {
  if (!machine.load_cell) return 0.0;
  const StructurePoint<double> point = structure_point(machine, motion, machine.load_cell->point);
  const Vector3d direction = motion.frame[0].R.transpose() * machine.load_cell->direction;
  return load_cell_force(*machine.load_cell, point, direction, input.yaw_rate);
}

template <class S>
Vector3<S> add_forces(const Machine& machine, const MotionOf<S>& motion, const StateOf<S>& state,
                      const Input& input, CoordinatesOf<S>& Q) noexcept {
  Q -= machine.damping.cwiseProduct(state.v);
  for (const Stop& stop : machine.stops) {
    Q[stop.coordinate] += stop_torque(stop, state.q[stop.coordinate], state.v[stop.coordinate]);
  }
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const Drive& drive = machine.drives[i];
    if (drive.kind != Drive::Kind::kGimbal) continue;
    const S torque = drive.torque(input.mode, input.drive[i], state.v[drive.coordinate]);
    Q[drive.coordinate] += input.drive_strength[i] * torque;
  }
  Vector3<S> on_disc = Vector3<S>::Zero();
  if (machine.disc_body != kFixed) on_disc = add_disc_forces(machine, motion, state, input, Q);

  const FrameOf<S>& structure = motion.frame[0];
  if (!input.force.isZero(0) || !input.moment.isZero(0)) {
    const Vector3<S> force = structure.R.transpose() * input.force;
    const Vector3<S> moment =
        structure.R.transpose() * input.moment + machine.push_point.cross(force);
    for (int i : machine.tree.angular(0)) Q[i] += structure.Jw[i].dot(moment);
  }
  if (machine.load_cell) {
    const LoadCell& cell = *machine.load_cell;
    const StructurePoint<S> point = structure_point(machine, motion, cell.point);
    const Vector3<S> direction = structure.R.transpose() * cell.direction;
    const S pressed = load_cell_force(cell, point, direction, input.yaw_rate);
    for (int i = 0; i < machine.coordinates(); ++i) Q[i] -= pressed * point.J[i].dot(direction);
  }
  return on_disc;
}

double spring_energy(const Machine& machine, const Motion& motion, const State& state) noexcept {
  double V = 0.0;
  for (const Stop& stop : machine.stops) {
    const double d = overshoot(stop, state.q[stop.coordinate]);
    V += 0.5 * stop.stiffness * d * d;
  }
  if (machine.disc_body != kFixed) {
    const double cos_tilt = motion.frame[0].R.col(2).dot(motion.frame[machine.disc_body].R.col(2));
    V += machine.bushing.stiffness * (1.0 - cos_tilt);
  }
  if (machine.load_cell) {
    const double x =
        compression(*machine.load_cell, structure_point(machine, motion, machine.load_cell->point));
    V += 0.5 * machine.load_cell->stiffness * x * x;
  }
  if (machine.track) {
    const auto tips = tips_of(machine, disc_motion(machine, motion), motion, state);
    V += contact_energy(*machine.track, tips.lower) + contact_energy(*machine.track, tips.upper);
  }
  return V;
}

template StructurePoint<double> structure_point(const Machine&, const Motion&,
                                                const Vector3d&) noexcept;
template StructurePoint<Dual> structure_point(const Machine&, const MotionOf<Dual>&,
                                              const Vector3d&) noexcept;
template double rate_of(const Machine&, const Motion&, const Drive&, const State&) noexcept;
template Vector3<double> add_forces(const Machine&, const Motion&, const State&, const Input&,
                                    Coordinates&) noexcept;
template Vector3<Dual> add_forces(const Machine&, const MotionOf<Dual>&, const StateOf<Dual>&,
                                  const Input&, CoordinatesOf<Dual>&) noexcept;

}  // namespace gyrotwin::model
