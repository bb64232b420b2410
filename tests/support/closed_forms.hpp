// Equations derived by hand, independent of the tree: oracles of services/model. Symbols and
// derivation: services/model/README.md, sections 2 and 5.
#pragma once

#include "services/model/gimballed.hpp"
#include "services/model/gyroscope.hpp"
#include "services/model/umbrella.hpp"

namespace gyrotwin::reference {

/// Spring `stiffness` on the overshoot d beyond `lower` or `upper`, and damping
/// 0.02 s stiffness v min(1, |d| / 0.01) while moving further in [N m].
double stop_torque(double lower, double upper, double stiffness, double q, double v);

/// q'' of a level umbrella (thx, thy, phi, tg) without track and bushing; friction, damping, stops
/// and a drive torque tau [N m] act.
model::Coordinates level_acceleration(const model::UmbrellaParameters& parameters,
                                      const model::State& state, double tau);

/// Energies of an umbrella of any mount without track and bushing, inside its stops.
struct UmbrellaEnergy {
  double T2;  ///< quadratic in the rates [J]
  double T1;  ///< linear in the rates: the rotors' momentum times the disc's spin [J]
  double V;   ///< gravity [J]
};
UmbrellaEnergy umbrella_energy(const model::UmbrellaParameters& parameters,
                               const model::Observation& motion);

/// q'' of (th, q) under a gimbal torque u and an external roll moment [N m].
model::Coordinates pair_acceleration(const model::GimballedParameters& parameters,
                                     const model::State& state, double u, double moment);
model::Coordinates single_acceleration(const model::GimballedParameters& parameters,
                                       const model::State& state, double u, double moment);

/// q'' of (thx, thy, qA, qB) under gimbal torques [N m].
model::Coordinates two_pairs_acceleration(const model::GimballedParameters& parameters,
                                          const model::State& state, double uA, double uB);

/// q'' of (psi, tg) under a torque tau [N m] on the post and a weight [N] at the tip.
model::Coordinates gyroscope_acceleration(const model::GyroscopeParameters& parameters,
                                          const model::State& state, double tau, double weight);

}  // namespace gyrotwin::reference
