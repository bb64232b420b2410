// What acts on a mechanism: services/model/README.md, section 3, from the motions of its links.
// Written once for all engines, which supply the motions and take the wrenches.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/bench/plant/mechanism.hpp"

namespace gyrotwin::bench {

/// Of a link's frame, seen from the ground.
struct Motion {
  Eigen::Matrix3d R;
  Eigen::Vector3d p, v;   ///< of the origin [m], [m/s]
  Eigen::Vector3d omega;  ///< [rad/s]
};
using Motions = std::array<Motion, kMaxLinks>;

/// On a link, world axes, about its frame's origin.
struct Wrench {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();
};
using Wrenches = std::array<Wrench, kMaxLinks>;

/// Hunt and Crossley's normal force along `side` z_S and rolling drag, on a gyro's axle tip; the
/// opposite on the structure at the same point.
inline void touch(const model::Track& track, const Motion& structure, const Motion& gyro,
                  Wrench& on_structure, Wrench& on_gyro) {
  const Eigen::Vector3d z_S = structure.R.col(2);
  const Eigen::Vector3d arm = track.tip * gyro.R.col(0);
  const Eigen::Vector3d from_S = gyro.p + arm - structure.p;
  const double height = z_S.dot(from_S);
  double side = 1.0, depth = track.height - height;
  if (depth <= 0.0) {
    if (!track.clearance) return;
    side = -1.0;
    depth = height - track.height - *track.clearance;
    if (depth <= 0.0) return;
  }
  const Eigen::Vector3d v =
      gyro.v + gyro.omega.cross(arm) - structure.v - structure.omega.cross(from_S);
  const double rise = z_S.dot(v);
  const double normal =
      track.stiffness * depth * std::sqrt(depth) * std::max(0.0, 1.0 - side * track.damping * rise);
  const Eigen::Vector3d along = v - rise * z_S;
  const double drag = track.rolling_drag * normal / std::sqrt(along.squaredNorm() + 1e-4);
  const Eigen::Vector3d force = side * normal * z_S - drag * along;
  on_gyro.force += force;
  on_gyro.moment += arm.cross(force);
  on_structure.force -= force;
  on_structure.moment -= from_S.cross(force);
}

/// Everything but what acts on coordinates. A flywheel of steady speed is the moment h x omega on
/// its link, which carries its mass and inertia.
inline void act(const Mechanism& mechanism, const Motions& motion,
                const model::RotorSpeeds& rotor_speed, const model::Input& input,
                Wrenches& wrench) {
  const std::size_t links = mechanism.links.size();
  for (std::size_t b = 0; b < links; ++b) {
    wrench[b] = {};
    const Link& link = mechanism.links[b];
    if (link.rotor_index < 0) continue;
    const double speed = rotor_speed[static_cast<std::size_t>(link.rotor_index)];
    const Eigen::Vector3d h = motion[b].R * (speed * link.rotor);
    wrench[b].moment = h.cross(motion[b].omega);
  }
  wrench[0].moment += input.moment;
  if (mechanism.has_disc) {
    const Eigen::Vector3d z_D = motion[1].R.col(2);
    const double spin = z_D.dot(motion[1].omega - motion[0].omega);
    const double torque = input.drive[0] - mechanism.friction.viscous * spin -
                          mechanism.friction.coulomb * std::tanh(spin / 0.05);
    wrench[1].moment += torque * z_D;
    wrench[0].moment -= torque * z_D;
  }
  if (!mechanism.track) return;
  for (std::size_t b = 2; b < links; ++b) {
    touch(*mechanism.track, motion[0], motion[b], wrench[0], wrench[b]);
  }
}

/// Damping, stops and gimbal drives: calls add(coordinate, generalised force).
template <class Add>
void act_on_coordinates(const Mechanism& mechanism, const double* c, const double* rate,
                        const model::Input& input, const Add& add) {
  for (int i = 0; i < mechanism.coordinates; ++i) add(i, -mechanism.damping[i] * rate[i]);
  for (const model::Stop& stop : mechanism.stops) {
    const double q = c[stop.coordinate], v = rate[stop.coordinate];
    const double d = q > stop.upper ? q - stop.upper : std::min(q - stop.lower, 0.0);
    if (d == 0.0) continue;
    double moment = stop.stiffness * d;
    if (d * v > 0.0) moment += 0.02 * stop.stiffness * v * std::min(1.0, std::abs(d) / 0.01);
    add(stop.coordinate, -moment);
  }
  for (std::size_t i = 0; i < mechanism.drives.size(); ++i) {
    add(mechanism.drives[i], input.drive[i]);
  }
}

}  // namespace gyrotwin::bench
