#include "services/model/contact.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin::model {

namespace {

// Regularises the direction of the rolling drag at standstill [m^2/s^2].
constexpr double kCreepSquared = 1e-4;

/// One contact: normal force along `side` * z_S on the gyro, rolling drag against v_rel, reaction
/// on the structure at the same point.
template <class S>
void add_force(const Machine& machine, const MotionOf<S>& motion, const TipMotion<S>& tip,
               double side, const S& force, CoordinatesOf<S>& Q) noexcept {
  using std::sqrt;
  const FrameOf<S>& structure = motion.frame[0];
  const FrameOf<S>& gyro = motion.frame[tip.body];
  const Vector3<S> z_S = structure.R.col(2);
  const Vector3<S> v_t = tip.v_rel - z_S.dot(tip.v_rel) * z_S;
  const S drag = machine.track->rolling_drag / sqrt(v_t.squaredNorm() + kCreepSquared);
  const Vector3<S> F = force * (side * z_S - drag * v_t);

  // Virtual power F . (v_tip - v_structure at the tip), coordinate by coordinate.
  const Vector3<S> gyro_moment = tip.arm.cross(F);
  const Vector3<S> structure_moment = (tip.p - structure.p).cross(F);
  for (int i : machine.tree.linear(tip.body)) Q[i] += gyro.Jv[i].dot(F);
  for (int i : machine.tree.angular(tip.body)) Q[i] += gyro.Jw[i].dot(gyro_moment);
  for (int i : machine.tree.linear(0)) Q[i] -= structure.Jv[i].dot(F);
  for (int i : machine.tree.angular(0)) Q[i] -= structure.Jw[i].dot(structure_moment);
}

}  // namespace

template <class S>
TipMotion<S> tip_motion(const Track& track, const MotionOf<S>& motion, int body) noexcept {
  const FrameOf<S>& structure = motion.frame[0];
  const FrameOf<S>& gyro = motion.frame[body];
  TipMotion<S> tip;
  tip.body = body;
  tip.arm = track.tip * gyro.R.col(0);
  tip.p = gyro.p + tip.arm;
  tip.v_rel = gyro.v + gyro.omega.cross(tip.arm) -
              (structure.v + structure.omega.cross(tip.p - structure.p));
  return tip;
}

template <class S>
Indentation<S> lower_indentation(const Track& track, const MotionOf<S>& motion,
                                 const TipMotion<S>& tip) noexcept {
  const Vector3<S> z_S = motion.frame[0].R.col(2);
  return {track.height - z_S.dot(tip.p), -z_S.dot(tip.v_rel)};
}

template <class S>
Indentation<S> upper_indentation(const Track& track, const MotionOf<S>& motion,
                                 const TipMotion<S>& tip) noexcept {
  if (!track.clearance) return {S(-1.0), S(0.0)};
  const Vector3<S> z_S = motion.frame[0].R.col(2);
  return {z_S.dot(tip.p) - (track.height + *track.clearance), z_S.dot(tip.v_rel)};
}

template <class S>
S normal_force(const Track& track, const Indentation<S>& indentation) noexcept {
  using std::max, std::sqrt;
  const S depth = indentation.depth;
  if (depth <= 0.0) return S(0.0);
  return track.stiffness * depth * sqrt(depth) *
         max(S(0.0), S(1.0 + track.damping * indentation.rate));
}

double contact_energy(const Track& track, const Indentation<double>& indentation) noexcept {
  const double depth = std::max(0.0, indentation.depth);
  return 0.4 * track.stiffness * depth * depth * std::sqrt(depth);
}

template <class S>
void add_contact(const Machine& machine, const MotionOf<S>& motion, CoordinatesOf<S>& Q) noexcept {
  const auto& bodies = machine.tree.bodies();
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    if (bodies[b].rotor_index < 0) continue;
    const TipMotion<S> tip = tip_motion(*machine.track, motion, b);
    const S lower = normal_force(*machine.track, lower_indentation(*machine.track, motion, tip));
    if (lower > 0.0) add_force(machine, motion, tip, +1.0, lower, Q);
    const S upper = normal_force(*machine.track, upper_indentation(*machine.track, motion, tip));
    if (upper > 0.0) add_force(machine, motion, tip, -1.0, upper, Q);
  }
}

template TipMotion<double> tip_motion(const Track&, const Motion&, int) noexcept;
template Indentation<double> lower_indentation(const Track&, const Motion&,
                                               const TipMotion<double>&) noexcept;
template Indentation<double> upper_indentation(const Track&, const Motion&,
                                               const TipMotion<double>&) noexcept;
template double normal_force(const Track&, const Indentation<double>&) noexcept;
template void add_contact(const Machine&, const Motion&, Coordinates&) noexcept;
template void add_contact(const Machine&, const MotionOf<Dual>&, CoordinatesOf<Dual>&) noexcept;

}  // namespace gyrotwin::model
