// Gyros that turn on a body, and what they add to its inertia. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "services/model/dual.hpp"

namespace gyrotwin::model {

inline constexpr int kMaxRotors = 4;
using RotorSpeeds = std::array<double, kMaxRotors>;

// What depends on coordinates and rates is written for a scalar S: double, or Dual for its
// derivative along a direction.
template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;

/// A symmetric 3 x 3 matrix as (xx, yy, zz, xy, xz, yz).
template <class S>
using Symmetric3 = Eigen::Matrix<S, 6, 1>;

/// A x.
template <class S>
Vector3<S> product(const Symmetric3<S>& A, const Vector3<S>& x) {
  return {A[0] * x[0] + A[3] * x[1] + A[4] * x[2],  //
          A[3] * x[0] + A[1] * x[1] + A[5] * x[2],  //
          A[4] * x[0] + A[5] * x[1] + A[2] * x[2]};
}

/// The rotors' speeds relative to their frames.
struct Rotors {
  RotorSpeeds speed;   ///< n [rad/s]
  RotorSpeeds rate{};  ///< n' [rad/s^2]
};

/// A unit of frame, motor and flywheel, symmetric about its spin axis, its cm on it. It turns about
/// a hinge through `pivot`, across that axis. Vectors are in the axes of the body that carries it.
struct Gyro {
  Eigen::Vector3d pivot;   ///< from the carrier's pivot [m]
  Eigen::Vector3d axis;    ///< unit, spin axis at angle 0
  Eigen::Vector3d raised;  ///< unit, spin axis at angle 90 deg
  double mass;             ///< flywheel included [kg]
  double cm_distance;      ///< d, pivot to cm along the spin axis [m]
  double axial_inertia;    ///< Ix, flywheel included [kg m^2]
  double planar_inertia;   ///< It, about the cm, flywheel included [kg m^2]
  double rotor_inertia;    ///< Ia, of the flywheel about its axis [kg m^2]
  int rotor_index;         ///< which rotor speed drives it

  /// The spin axis at the angle with this cosine and sine.
  template <class S>
  Vector3<S> axis_at(const S& c, const S& s) const {
    return c * axis + s * raised;
  }
};

/// Mass, first and second moment (tensor of inertia) about a body's pivot, in its axes.
struct MassMoments {
  double mass = 0.0;                                       ///< [kg]
  Eigen::Vector3d first = Eigen::Vector3d::Zero();         ///< [kg m]
  Symmetric3<double> second = Symmetric3<double>::Zero();  ///< [kg m^2]

  void add(const MassMoments& other);
};

/// Of a rigid body. @param inertia principal, about cm, in the axes of `cm` [kg m^2]
MassMoments moments_of(double mass, const Eigen::Vector3d& cm, const Eigen::Vector3d& inertia);

/// What a gimbal adds to its carrier at one angle; x_q is dx/dq. About the carrier's pivot, in its
/// axes.
template <class S>
struct GimbalShareOf {
  Vector3<S> first, first_q;       ///< varying part of the first moment [kg m]
  Symmetric3<S> second, second_q;  ///< varying part of the second moment [kg m^2]
  Vector3<S> swing, swing_q;       ///< angular momentum of a unit rate of the angle [kg m^2]
  Vector3<S> h, h_q, h_t;          ///< rotor momentum [N m s], and by time
};

/// Gyros that turn on one body by one angle q, geared 1 : 1 or 1 : -1. All that they add to the
/// body's inertia is a trigonometric polynomial in q, however many they are.
class Gimbal {
 public:
  /// @param coordinate which of the tree's is q
  Gimbal(int carrier, int coordinate, std::vector<Gyro> gyros);

  int carrier() const { return carrier_; }
  int coordinate() const { return coordinate_; }
  const std::vector<Gyro>& gyros() const { return gyros_; }

  /// What of the gyros' moments does not depend on q.
  const MassMoments& fixed() const { return fixed_; }
  /// Of all gyros about their hinges [kg m^2].
  double inertia() const { return inertia_; }

  /// @param c, s cosine and sine of q
  template <class S>
  GimbalShareOf<S> at(const S& c, const S& s, const Rotors& rotors) const noexcept;

 private:
  /// x = cosine cos(k q) + sine sin(k q).
  template <int N>
  struct Harmonic {
    Eigen::Matrix<double, N, 1> cosine = Eigen::Matrix<double, N, 1>::Zero();
    Eigen::Matrix<double, N, 1> sine = Eigen::Matrix<double, N, 1>::Zero();
  };
  void add(const Gyro& gyro);

  int carrier_, coordinate_;
  std::vector<Gyro> gyros_;
  MassMoments fixed_;
  double inertia_ = 0.0;
  Harmonic<3> first_, swing_;
  Eigen::Vector3d swing_fixed_ = Eigen::Vector3d::Zero();
  Harmonic<6> second_, second_twice_;  // the latter in 2 q
};

}  // namespace gyrotwin::model
