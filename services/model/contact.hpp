// The gyros' axle tips on the ring, all at once. Derivation: README.md, section 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// A number or a vector a gyro, in the order of the gimbal's; rows beyond its gyros mean nothing.
template <class S>
using PerGyro = Eigen::Array<S, kMaxRotors, 1>;
template <class S>
using VectorPerGyro = Eigen::Array<S, kMaxRotors, 3>;

/// The disc against the structure that carries it; refers to the motion that it is made of.
template <class S>
struct DiscMotionOf {
  const Matrix3<S>& R;  ///< structure <- disc
  Vector3<S> omega;     ///< angular velocity against the structure, disc axes [rad/s]
};

template <class S>
DiscMotionOf<S> disc_motion(const Machine& machine, const MotionOf<S>& motion) noexcept {
  const FrameOf<S>& structure = motion.frame[0];
  const FrameOf<S>& disc = motion.frame[machine.disc_body];
  return {disc.R_carrier, disc.omega - disc.R_carrier.transpose() * structure.omega};
}

/// How far the axle tips are into a side of the track, and how fast they go deeper.
template <class S>
struct IndentationOf {
  PerGyro<S> depth;  ///< delta [m]; <= 0: no contact
  PerGyro<S> rate;   ///< delta' [m/s]
};

/// The axle tips against the structure, in the axes of the disc.
template <class S>
struct TipsOf {
  VectorPerGyro<S> arm;        ///< from the disc's joint [m]
  VectorPerGyro<S> per_angle;  ///< how the tips move on the disc with the gimbal's angle [m/rad]
  VectorPerGyro<S> v_rel;      ///< velocity relative to the structure at the same point [m/s]
  IndentationOf<S> lower;
  IndentationOf<S> upper;  ///< never in contact where the track has no upper side
};

template <class S>
TipsOf<S> tips_of(const Machine& machine, const DiscMotionOf<S>& disc, const MotionOf<S>& motion,
                  const StateOf<S>& state) noexcept;

/// Hunt-Crossley normal forces F_n = kc delta^1.5 max(0, 1 + cc delta') [N].
template <class S>
PerGyro<S> normal_force(const Track& track, const IndentationOf<S>& indentation) noexcept;
/// Energy in the contact springs, 2/5 kc delta^2.5 [J].
double contact_energy(const Track& track, const IndentationOf<double>& indentation) noexcept;

/// What the ring does to all tips: Q of the gimbal. @return its moment on the disc about its joint
/// [N m], disc axes; the structure has the opposite one
template <class S>
Vector3<S> add_contact(const Machine& machine, const DiscMotionOf<S>& disc,
                       const MotionOf<S>& motion, const StateOf<S>& state,
                       CoordinatesOf<S>& Q) noexcept;

}  // namespace gyrotwin::model
