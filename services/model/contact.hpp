// The gyros' axle tips on the ring. Derivation: README.md, section 3.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// How far one axle tip is into a track, and how fast it goes deeper.
struct Indentation {
  double depth;  ///< delta [m]; <= 0: no contact
  double rate;   ///< delta' [m/s]
};

/// Motion of one axle tip relative to the structure at the same point.
struct TipMotion {
  int body;               ///< the gyro
  Eigen::Vector3d arm;    ///< tip from the gyro's pivot, world [m]
  Eigen::Vector3d p;      ///< tip, world [m]
  Eigen::Vector3d v_rel;  ///< velocity relative to the structure [m/s]
};

TipMotion tip_motion(const Track& track, const Motion& motion, int body) noexcept;
Indentation lower_indentation(const Track& track, const Motion& motion,
                              const TipMotion& tip) noexcept;
/// Never in contact where the track has no upper side.
Indentation upper_indentation(const Track& track, const Motion& motion,
                              const TipMotion& tip) noexcept;

/// Hunt-Crossley normal force F_n = kc delta^1.5 max(0, 1 + cc delta') [N].
double normal_force(const Track& track, const Indentation& indentation) noexcept;
/// Energy in the contact spring, 2/5 kc delta^2.5 [J].
double contact_energy(const Track& track, const Indentation& indentation) noexcept;

/// Adds what the ring and the tips of all gyros do to each other to Q.
void add_contact(const Machine& machine, const Motion& motion, Coordinates& Q) noexcept;

}  // namespace gyrotwin::model
