// A single gyro on a stand: the axle turns about a vertical post and tips about a hinge on it.
#pragma once

#include "services/model/machine.hpp"

namespace gyrotwin::model {

inline constexpr int kPrecession = 0, kElevation = 1;  ///< coordinates of a gyroscope

/// Body 0 is the axle with its gyro, body 1 what of the post turns without tipping.
inline constexpr Shape kGyroscopeShape =
    Shape()
        .hang(kGround, kGround, {{Axis::kZ, kPrecession}, {Axis::kY, kElevation, -1}})
        .cm_along(kAlongX)
        .with_rotor()
        .hang(kGround, kGround, {{Axis::kZ, kPrecession}});

/// SI units; symbols as in README.md.
struct GyroscopeParameters {
  struct Gyro {
    double mass;                ///< mg, of all that tips: axle, frame, flywheel [kg]
    double inertia_transverse;  ///< It, about its cm [kg m^2]
    double inertia_axial;       ///< Ix, flywheel included [kg m^2]
    double rotor_inertia;       ///< Ia [kg m^2]
    double rotor_speed;         ///< n [rad/s], > 0: momentum points outward
    double cm_distance;         ///< d, hinge to cm along the axle [m]
    double axle_length;         ///< l, hinge to the tip, where loads act [m]
    double stop;                ///< tgmax, stops of the elevation at +-tgmax [rad]
    double stop_stiffness;      ///< [N m/rad]
    double hinge_damping;       ///< cg, on the elevation [N m s/rad]
    double post_damping;        ///< cp, on the precession [N m s/rad]
    double post_inertia;        ///< Jp, of what turns about the post but does not tip [kg m^2]
  } gyro;

  double torque_limit;  ///< of the drive that turns the post [N m]
};

/// Coordinates: (psi, tg): precession about the vertical, elevation (> 0 raises the tip). Body 0,
/// the structure of Input's wrench, is the axle with its gyro, and the force acts at the tip. In
/// Layout psi is the disc's angle and tg the gimbal's; there is no tilt. The one drive turns psi.
Machine build(const GyroscopeParameters& parameters);

}  // namespace gyrotwin::model
