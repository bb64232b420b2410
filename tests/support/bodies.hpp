// A machine's bodies one by one, its gyros among them, for tests that sum over them.
#pragma once

#include <cmath>
#include <vector>

#include "services/model/machine.hpp"

namespace gyrotwin {

/// One rigid body at one instant; world axes.
struct MovingBody {
  double mass = 0.0;           ///< [kg]
  Eigen::Vector3d p, v, a;     ///< centre of mass [m], [m/s], minus gravity [m/s^2]
  Eigen::Vector3d omega;       ///< in space [rad/s]
  Eigen::Vector3d alpha;       ///< [rad/s^2]
  Eigen::Matrix3d inertia;     ///< about the centre of mass [kg m^2]
  Eigen::Vector3d rotor_axis;  ///< its rotor's inertia along the spin axis [kg m^2]
  int rotor_index = -1;        ///< -1: no rotor
};

/// Bodies, then gyros. @param acceleration q'' [rad/s^2]
inline std::vector<MovingBody> moving_bodies(
    const model::Machine& machine, const model::State& state, const model::Support& support,
    const model::Coordinates& acceleration = model::Coordinates::Zero()) {
  using Eigen::Matrix3d, Eigen::Vector3d;
  const model::Tree& tree = machine.tree;
  model::Motion motion;
  tree.evaluate(state.q, state.v, {state.rotor_speed}, support, motion);
  const model::Frame& S = motion.frame[0];

  // Of the pivots, which the ground or the structure carries.
  struct Pivot {
    Vector3d p, v, a, omega, alpha;
  };
  std::vector<Pivot> pivots;
  std::vector<MovingBody> moving;
  for (int b = 0; b < tree.shape().bodies.size; ++b) {
    const model::Frame& frame = motion.frame[b];
    const model::Body& body = tree.bodies()[b];
    Pivot pivot{Vector3d::Zero(), Vector3d::Zero(), frame.R * frame.a0, frame.R * frame.omega,
                frame.R * frame.alpha0};
    if (tree.shape().bodies[b].position_parent != model::kGround) {
      pivot.p = S.R * body.pivot;
      pivot.v = (S.R * S.omega).cross(pivot.p);
    }
    for (int i : tree.linear(b)) pivot.a += frame.R * frame.Jv[i] * acceleration[i];
    for (int i : tree.angular(b)) pivot.alpha += frame.R * frame.Jw[i] * acceleration[i];
    pivots.push_back(pivot);

    const Vector3d rho = frame.R * body.cm, w = pivot.omega;
    MovingBody found;
    found.mass = body.mass;
    found.p = pivot.p + rho;
    found.v = pivot.v + w.cross(rho);
    found.a = pivot.a + pivot.alpha.cross(rho) + w.cross(w.cross(rho));
    found.omega = w;
    found.alpha = pivot.alpha;
    found.inertia = frame.R * body.inertia.asDiagonal() * frame.R.transpose();
    found.rotor_axis = frame.R * body.rotor;
    found.rotor_index = body.rotor_index;
    moving.push_back(found);
  }
  for (std::size_t g = 0; g < tree.gimbals().size(); ++g) {
    const auto& [b, k, lie] = tree.shape().gimbals.item[g];
    const Pivot& carrier = pivots[static_cast<std::size_t>(b)];
    const Matrix3d& R = motion.frame[b].R;
    const Vector3d w = carrier.omega;
    for (const model::Gyro& gyro : tree.gimbals()[g].gyros()) {
      const Vector3d hinge = R * gyro.axis.cross(gyro.raised);
      const Vector3d s =
          R * (std::cos(state.q[k]) * gyro.axis + std::sin(state.q[k]) * gyro.raised);
      const Vector3d r = R * gyro.pivot, rho = gyro.cm_distance * s;
      MovingBody found;
      found.mass = gyro.mass;
      found.omega = w + state.v[k] * hinge;
      found.alpha = carrier.alpha + acceleration[k] * hinge + state.v[k] * w.cross(hinge);
      found.p = carrier.p + r + rho;
      found.v = carrier.v + w.cross(r) + found.omega.cross(rho);
      found.a = carrier.a + carrier.alpha.cross(r) + w.cross(w.cross(r)) + found.alpha.cross(rho) +
                found.omega.cross(found.omega.cross(rho));
      found.inertia = gyro.planar_inertia * Matrix3d::Identity() +
                      (gyro.axial_inertia - gyro.planar_inertia) * s * s.transpose();
      found.rotor_axis = gyro.rotor_inertia * s;
      found.rotor_index = gyro.rotor_index;
      moving.push_back(found);
    }
  }
  return moving;
}

}  // namespace gyrotwin
