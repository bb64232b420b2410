// Gimballed gyros in a body that stands on a line or a point: gyro car, Brennan monorail, double
// Brennan.
#pragma once

#include <cstdint>

#include "services/model/machine.hpp"

namespace gyrotwin::model {

enum class Arrangement : std::uint8_t {
  kSingle,    ///< one gyro: rotor axis z, gimbal axis y (across the roll axis); stands on a line
  kPair,      ///< two counter-rotating gyros: rotor axes y, gimbal axes z, geared 1:-1; stands on a
              ///< line
  kTwoPairs,  ///< a pair for roll (rotor axes y) and one for pitch (rotor axes x); stands on a
              ///< point
};

/// The one body is the chassis.
constexpr Shape shape_of(Arrangement arrangement) {
  Shape::Gyros gyros;
  gyros.pivot = gyros.axis = kAlongZ;
  gyros.raised = kAlongX;
  gyros.centred = true;
  gyros.rotors = 1;
  Shape on_line = Shape().hang(kGround, kGround, {{Axis::kX, 0}});
  if (arrangement == Arrangement::kSingle) return on_line.gimbal(0, gyros);
  gyros.axis = kAlongY;
  gyros.balanced = true;
  gyros.rotors = 2;
  if (arrangement == Arrangement::kPair) return on_line.gimbal(0, gyros);
  Shape on_point = Shape().hang(kGround, kGround, {{Axis::kX, 0}, {Axis::kY, 1}}).gimbal(0, gyros);
  gyros.axis = kAlongX;
  gyros.raised = kAlongY;
  gyros.first_rotor = 2;
  return on_point.gimbal(0, gyros);
}

/// SI units; symbols as in README.md.
struct GimballedParameters {
  Arrangement arrangement = Arrangement::kPair;

  struct Structure {
    double mass;               ///< m, everything [kg]
    double cm_height;          ///< zc, of everything above the support [m]
    double inertia_tilt;       ///< Ixx0 about the support, gyro masses at zc included [kg m^2]
    double inertia_yaw_ratio;  ///< chassis' Izz / Ixx about its own cm [1]
    double damping;            ///< cth, per tilt coordinate [N m s/rad]
  } structure;

  struct Gyros {
    double mass;                ///< of one gyro unit [kg]
    double inertia_transverse;  ///< It [kg m^2]
    double inertia_axial;       ///< Ix, flywheel included [kg m^2]
    double rotor_inertia;       ///< Ia [kg m^2]
    double rotor_speed;         ///< n [rad/s]
    double stop;                ///< qmax, stops at +-qmax [rad]
    double stop_stiffness;      ///< [N m/rad]
    double damping;             ///< cq, per gimbal coordinate [N m s/rad]
  } gyros;

  double torque_limit;  ///< of each gimbal drive, on its coordinate [N m]
};

/// Coordinates: (th, q) for single and pair, (thx, thy, qA, qB) for two pairs.
Machine build(const GimballedParameters& parameters);

/// One tilt axis linearised at rest: A th'' + cth th' - U th - H q' = M, J q'' + cq q' + H th' = u.
/// The single gyro's row has H with the other sign; `sign` is +1 (pair) or -1 (single).
struct ReducedGimballed {
  double A;    ///< tilt inertia [kg m^2]
  double J;    ///< gimbal inertia of the coordinate [kg m^2]
  double U;    ///< toppling stiffness [N m/rad]
  double H;    ///< momentum that the coordinate turns [N m s]
  double cth;  ///< [N m s/rad]
  double cq;   ///< [N m s/rad]
};
ReducedGimballed reduce(const GimballedParameters& parameters);

}  // namespace gyrotwin::model
