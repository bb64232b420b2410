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

/// Motion of one axle tip relative to the structure at the same point.
template <class S>
struct TipMotion {
  int body;          ///< the gyro
  Vector3<S> arm;    ///< tip from the gyro's pivot, world [m]
  Vector3<S> p;      ///< tip, world [m]
  Vector3<S> v_rel;  ///< velocity relative to the structure [m/s]
};

template <class S>
TipMotion<S> tip_motion(const Track& track, const MotionOf<S>& motion, int body) noexcept;
template <class S>
Indentation<S> lower_indentation(const Track& track, const MotionOf<S>& motion,
                                 const TipMotion<S>& tip) noexcept;
/// Never in contact where the track has no upper side.
template <class S>
Indentation<S> upper_indentation(const Track& track, const MotionOf<S>& motion,
                                 const TipMotion<S>& tip) noexcept;

/// Hunt-Crossley normal force F_n = kc delta^1.5 max(0, 1 + cc delta') [N].
template <class S>
S normal_force(const Track& track, const Indentation<S>& indentation) noexcept;
/// Energy in the contact spring, 2/5 kc delta^2.5 [J].
double contact_energy(const Track& track, const Indentation<double>& indentation) noexcept;

/// Adds what the ring and the tips of all gyros do to each other to Q.
template <class S>
void add_contact(const Machine& machine, const MotionOf<S>& motion, CoordinatesOf<S>& Q) noexcept;

}  // namespace gyrotwin::model
