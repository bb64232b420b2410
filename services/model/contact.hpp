// The gyros' axle tips on the ring. Derivation: README.md, section 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// How far one axle tip is into a track, and how fast it goes deeper.
template <class S>
struct Indentation {
  S depth;  ///< delta [m]; <= 0: no contact
  S rate;   ///< delta' [m/s]
};

/// One axle tip against the structure, in the axes of the disc.
template <class S>
struct TipOf {
  Vector3<S> up;         ///< z_S
  Vector3<S> arm;        ///< tip from the disc's joint [m]
  Vector3<S> per_angle;  ///< how the tip moves on the disc with the gimbal's angle [m/rad]
  Vector3<S> v_rel;      ///< velocity relative to the structure at the same point [m/s]
  Indentation<S> lower;
  Indentation<S> upper;  ///< never in contact where the track has no upper side
};

/// Hunt-Crossley normal force F_n = kc delta^1.5 max(0, 1 + cc delta') [N].
template <class S>
S normal_force(const Track& track, const Indentation<S>& indentation) noexcept {
  using std::max, std::sqrt;
  const S depth = indentation.depth;
  if (depth <= 0.0) return S(0.0);
  return track.stiffness * depth * sqrt(depth) *
         max(S(0.0), S(1.0 + track.damping * indentation.rate));
}

/// Energy in the contact spring, 2/5 kc delta^2.5 [J].
double contact_energy(const Track& track, const Indentation<double>& indentation) noexcept;

/// Calls visit(gyro, tip) for the tip of every gyro.
template <class S, class Visit>
void visit_tips(const Machine& machine, const MotionOf<S>& motion, const StateOf<S>& state,
                const Visit& visit) noexcept {
  const Track& track = *machine.track;
  const FrameOf<S>& structure = motion.frame[0];
  const FrameOf<S>& disc = motion.frame[machine.disc_body];
  const double joint_height = machine.tree.bodies()[machine.disc_body].pivot.z();
  TipOf<S> tip;
  tip.up = disc.R.transpose() * structure.R.col(2);
  const Vector3<S> omega = disc.R.transpose() * (disc.omega - structure.omega);
  for (const Gimbal& gimbal : machine.tree.gimbals()) {
    const int k = gimbal.coordinate();
    for (const Gyro& gyro : gimbal.gyros()) {
      tip.arm = gyro.pivot + track.tip * gyro.axis_at(motion.cos_q[k], motion.sin_q[k]);
      tip.per_angle = track.tip * gyro.axis_at(S(-motion.sin_q[k]), motion.cos_q[k]);
      tip.v_rel = omega.cross(tip.arm) + state.v[k] * tip.per_angle;
      const S above = joint_height + tip.up.dot(tip.arm) - track.height;
      const S rising = tip.up.dot(tip.v_rel);
      tip.lower = {-above, -rising};
      tip.upper = track.clearance ? Indentation<S>{above - *track.clearance, rising}
                                  : Indentation<S>{S(-1.0), S(0.0)};
      visit(gyro, tip);
    }
  }
}

/// What the ring does to all tips: Q of the gimbal. @return its moment on the disc about its joint
/// [N m], disc axes; the structure has the opposite one
template <class S>
Vector3<S> add_contact(const Machine& machine, const MotionOf<S>& motion, const StateOf<S>& state,
                       CoordinatesOf<S>& Q) noexcept;

}  // namespace gyrotwin::model
