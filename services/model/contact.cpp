#include "services/model/contact.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

// Regularises the direction of the rolling drag at standstill [m^2/s^2].
constexpr double kCreepSquared = 1e-4;

/// One contact: normal force along `side` * z_S on the gyro, rolling drag against v_rel, reaction
/// on the structure at the same point.
void add_force(const Machine& machine, const Motion& motion, const TipMotion& tip, double side,
               double force, Coordinates& Q) noexcept {
  const Frame& structure = motion.frame[0];
  const Frame& gyro = motion.frame[tip.body];
  const Vector3d z_S = structure.R.col(2);
  const Vector3d v_t = tip.v_rel - z_S.dot(tip.v_rel) * z_S;
  const double drag = machine.track->rolling_drag / std::sqrt(v_t.squaredNorm() + kCreepSquared);
  const Vector3d F = force * (side * z_S - drag * v_t);

  // Virtual power F . (v_tip - v_structure at the tip), coordinate by coordinate.
  const Vector3d gyro_moment = tip.arm.cross(F);
  const Vector3d structure_moment = (tip.p - structure.p).cross(F);
  for (int i : machine.tree.linear(tip.body)) Q[i] += gyro.Jv[i].dot(F);
  for (int i : machine.tree.angular(tip.body)) Q[i] += gyro.Jw[i].dot(gyro_moment);
  for (int i : machine.tree.linear(0)) Q[i] -= structure.Jv[i].dot(F);
  for (int i : machine.tree.angular(0)) Q[i] -= structure.Jw[i].dot(structure_moment);
}

}  // namespace

TipMotion tip_motion(const Track& track, const Motion& motion, int body) noexcept {
  const Frame& structure = motion.frame[0];
  const Frame& gyro = motion.frame[body];
  TipMotion tip;
  tip.body = body;
  tip.arm = track.tip * gyro.R.col(0);
  tip.p = gyro.p + tip.arm;
  tip.v_rel = gyro.v + gyro.omega.cross(tip.arm) -
              (structure.v + structure.omega.cross(tip.p - structure.p));
  return tip;
}

Indentation lower_indentation(const Track& track, const Motion& motion,
                              const TipMotion& tip) noexcept {
  const Vector3d z_S = motion.frame[0].R.col(2);
  return {track.height - z_S.dot(tip.p), -z_S.dot(tip.v_rel)};
}

Indentation upper_indentation(const Track& track, const Motion& motion,
                              const TipMotion& tip) noexcept {
  if (!track.clearance) return {-1.0, 0.0};
  const Vector3d z_S = motion.frame[0].R.col(2);
  return {z_S.dot(tip.p) - (track.height + *track.clearance), z_S.dot(tip.v_rel)};
}

double normal_force(const Track& track, const Indentation& indentation) noexcept {
  const double depth = indentation.depth;
  if (depth <= 0.0) return 0.0;
  return track.stiffness * depth * std::sqrt(depth) *
         std::max(0.0, 1.0 + track.damping * indentation.rate);
}

double contact_energy(const Track& track, const Indentation& indentation) noexcept {
  const double depth = std::max(0.0, indentation.depth);
  return 0.4 * track.stiffness * depth * depth * std::sqrt(depth);
}

void add_contact(const Machine& machine, const Motion& motion, Coordinates& Q) noexcept {
  const auto& bodies = machine.tree.bodies();
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    if (bodies[b].rotor_index < 0) continue;
    const TipMotion tip = tip_motion(*machine.track, motion, b);
    const double lower =
        normal_force(*machine.track, lower_indentation(*machine.track, motion, tip));
    if (lower > 0.0) add_force(machine, motion, tip, +1.0, lower, Q);
    const double upper =
        normal_force(*machine.track, upper_indentation(*machine.track, motion, tip));
    if (upper > 0.0) add_force(machine, motion, tip, -1.0, upper, Q);
  }
}

}  // namespace gyrotwin::model
