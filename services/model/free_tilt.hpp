// How an umbrella platform tilts while its disc turns and its gyros stay at one elevation: the two
// bodies of README.md, section 4.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/model/umbrella.hpp"

namespace gyrotwin::model {

/// What the tilt equations are made of.
struct FreeTilt {
  double U, P;         ///< what the weight does to structure and disc [N m/rad]
  Eigen::Vector2d Js;  ///< structure about the ground, the disc's mass at its joint; roll, pitch
                       ///< [kg m^2]
  double Jd;           ///< disc and gyros about a diameter through the joint [kg m^2]
  double S1;           ///< their first moment about the joint, upward [kg m]
  double Jz;           ///< about the disc's axis, geared motor included [kg m^2]
  double spin;         ///< N h sin tg, of the flywheels along the disc's axis [N m s]
  double hd;           ///< [m]

  /// L, along the disc's axis when it turns at `speed` [rad/s] [N m s].
  double momentum(double speed) const { return Jz * speed + spin; }
  /// Jt, of everything locked together, about the ground; roll, pitch [kg m^2].
  Eigen::Vector2d locked_inertia() const {
    return Js + Eigen::Vector2d::Constant(Jd + 2.0 * hd * S1);
  }
};

/// @param elevation tg at which the gyros stay [rad]
FreeTilt free_tilt(const UmbrellaParameters& parameters, double elevation);

/// Largest growth of small tilts [1/s], nothing but `between` joining structure and disc.
/// @param mount level: the disc does not tilt; rigid: it tilts with the structure
/// @param ground_damping cs [N m s/rad]
/// @param speed Omega, of the disc [rad/s]
double tilt_growth(const FreeTilt& tilt, Mount mount, const TiltBushing& between,
                   double ground_damping, double speed);

/// Both rates of the locked top, Jt z'' - i L z' - (U - P) z = 0, where it stands [rad/s].
struct Precession {
  double slow, fast;  ///< magnitudes
};
/// @param speed Omega, of the disc [rad/s]
std::optional<Precession> precession(const FreeTilt& tilt, double speed);

}  // namespace gyrotwin::model
