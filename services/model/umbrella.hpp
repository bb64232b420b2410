// Umbrella platform: structure, disc on a central joint, N linked gyros whose outer axles ride on a
// ring.
#pragma once

#include <cstdint>

#include "services/model/machine.hpp"

namespace gyrotwin::model {

/// How the disc sits on the structure. README.md, section 1, says which is whose reading.
enum class Mount : std::uint8_t {
  kLevel,           ///< held level by an unstated external support
  kUniversalJoint,  ///< free to tilt: two coordinates more
  kRigid,           ///< tilts with the structure
};

/// Body 0 is the structure, 1 the disc, which carries the gyros.
constexpr Shape shape_of(Mount mount) {
  using Turns = ShortList<Rotation, 4>;
  const bool free = mount == Mount::kUniversalJoint;
  Shape::Gyros gyros;
  gyros.axis = kAlongX + kAlongY;
  gyros.raised = kAlongZ;
  gyros.balanced = true;
  return Shape()
      .hang(kGround, kGround, {{Axis::kX, 0}, {Axis::kY, 1}})
      .hang(0, mount == Mount::kRigid ? 0 : kGround,
            free ? Turns{{Axis::kX, 2}, {Axis::kY, 3}, {Axis::kZ, 4}} : Turns{{Axis::kZ, 2}})
      .gimbal(1, gyros);
}

/// What the outer axles ride on.
enum class TrackKind : std::uint8_t { kNone, kLower, kSlot };

/// SI units; symbols as in README.md.
struct UmbrellaParameters {
  Mount mount = Mount::kLevel;
  TrackKind track = TrackKind::kLower;

  struct Structure {
    double mass;                  ///< ms [kg]
    double cm_height;             ///< r, above the ground pivot [m]
    double inertia_x, inertia_y;  ///< Isx, Isy about the ground pivot [kg m^2]
    double inertia_z;             ///< Isz [kg m^2]
    double damping;               ///< cs, on both tilt coordinates [N m s/rad]
  } structure;

  struct Disc {
    double joint_height;      ///< hd, of the disc's joint above the ground pivot [m]
    double mass;              ///< mD [kg]
    double cm_offset;         ///< eD, centre of mass above the joint (< 0: below) [m]
    double inertia_planar;    ///< IDp, about a diameter through cm [kg m^2]
    double inertia_polar;     ///< IDz [kg m^2]
    double viscous_friction;  ///< bD [N m s/rad]
    double coulomb_friction;  ///< fcD [N m]
  } disc;

  struct Gyros {
    int count;                  ///< N, 3 or 4
    double mass;                ///< mg, frame + motor + flywheel [kg]
    double inertia_transverse;  ///< It, about the unit's cm [kg m^2]
    double inertia_axial;       ///< Ix, flywheel included [kg m^2]
    double rotor_inertia;       ///< Ia [kg m^2]
    double rotor_speed;         ///< n [rad/s], > 0: momentum points outward
    double pivot_radius;        ///< rp [m]
    double pivot_height;        ///< zp, above the disc's joint [m]
    double axle_length;         ///< l, pivot to outer axle tip [m]
    double cm_distance;         ///< d, pivot to cm along the axle [m]
    double ring_elevation;      ///< tg0, elevation that touches the untilted ring [rad]
    double stop_lower;          ///< tgmin [rad]
    double stop_upper;          ///< tgmax [rad]
    double stop_stiffness;      ///< kst [N m/rad]
    double damping;             ///< cg, on the common elevation [N m s/rad]
  } gyros;

  struct Contact {
    double stiffness;       ///< kc [N/m^1.5]
    double damping;         ///< cc [s/m]
    double rolling_drag;    ///< mu [1]
    double slot_clearance;  ///< height of the slot above the axles, track `slot` [m]
  } contact;

  TiltBushing bushing;

  struct DiscDrive {
    double motor_inertia;  ///< Jm, added to IDz as Jm G^2 [kg m^2]
    Motor motor;
    double torque_limit;  ///< [N m]
  } drive;
};

/// Coordinates: (thx, thy, phi, tg), or (thx, thy, bx, by, phi, tg) with Mount::kUniversalJoint.
/// @pre parameters are finite and physical (runtime/rig.hpp checks).
Machine build(const UmbrellaParameters& parameters);

/// The planar reduced model of section 4: A th'' = U th + H phi', C phi'' = tau - H th'.
struct ReducedUmbrella {
  double A;   ///< tilt inertia [kg m^2]
  double C;   ///< disc spin inertia at tg0, geared motor included [kg m^2]
  double U;   ///< toppling stiffness [N m/rad]
  double H;   ///< coupling, N h cos(tg0) k [N m s]
  double k;   ///< elevation per tilt, (rp + l cos tg0) / (l cos tg0) [1]
  double Nh;  ///< sum of the flywheels' momenta [N m s]

  /// H^2 / (C U): above 1 the level platform oscillates instead of falling.
  double stability_ratio() const { return H * H / (C * U); }
};
ReducedUmbrella reduce(const UmbrellaParameters& parameters);

}  // namespace gyrotwin::model
