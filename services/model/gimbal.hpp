// Gyros that turn on a body, and what they add to its inertia. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "services/model/dual.hpp"
#include "services/model/pattern.hpp"

namespace gyrotwin::model {

using RotorSpeeds = std::array<double, kMaxRotors>;

/// Rates of rotors that keep their speed.
inline constexpr RotorSpeeds kSteady{};

/// The rotors' speeds relative to their frames; refers to what it is made of.
struct Rotors {
  const RotorSpeeds& speed;           ///< n [rad/s]
  const RotorSpeeds& rate = kSteady;  ///< n' [rad/s^2]
};

// What depends on coordinates and rates is written for a scalar S: double, or Dual for its
// derivative along a direction.
template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;

/// First moment sum m r [kg m] and second moment, the tensor of inertia [kg m^2], about a body's
/// pivot, in its axes; or how they vary.
template <class S>
struct Moments {
  Vector3<S> first = Vector3<S>::Zero();
  Eigen::Matrix<S, 6, 1> second = Eigen::Matrix<S, 6, 1>::Zero();  ///< xx, yy, zz, xy, xz, yz

  /// Adds k times the other.
  void add(const S& k, const Moments<double>& other) {
    first += k * other.first;
    second += k * other.second;
  }
  void add(const Moments& other) {
    first += other.first;
    second += other.second;
  }
  Vector3<S> second_times(const Vector3<S>& x) const {
    const auto& J = second;
    return {J[0] * x[0] + J[3] * x[1] + J[4] * x[2], J[3] * x[0] + J[1] * x[1] + J[5] * x[2],
            J[4] * x[0] + J[5] * x[1] + J[2] * x[2]};
  }
};

/// Of a rigid body. @param inertia principal, about cm, in the axes of `cm` [kg m^2]
Moments<double> moments_of(double mass, const Eigen::Vector3d& cm, const Eigen::Vector3d& inertia);

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
};

/// Gyros that turn on one body by one angle q, geared 1 : 1 or 1 : -1. All that they add to the
/// body's inertia is a trigonometric polynomial in q, however many they are.
class Gimbal {
 public:
  using Rows = Eigen::Array<double, kMaxRotors, 3>;
  using Terms = GimbalTerms<Moments<double>, Eigen::Vector3d>;

  /// @throws std::invalid_argument for more than 4 gyros, or an unknown rotor
  explicit Gimbal(std::vector<Gyro> gyros);

  const std::vector<Gyro>& gyros() const { return gyros_; }
  /// Their pivots and axes, one row a gyro.
  const Rows& pivots() const { return pivots_; }
  const Rows& axes() const { return axes_; }
  const Rows& raised_axes() const { return raised_axes_; }

  double mass() const { return mass_; }
  /// Of all gyros about their hinges [kg m^2].
  double inertia() const { return inertia_; }
  /// Whether the gyros lie so; but for rounding.
  bool lie_as(const Shape::Gyros& gyros) const;

  /// What they add to their carrier, about its pivot and in its axes.
  const Terms& terms() const { return terms_; }
  /// The rotors' momenta at unit speed, with the gimbal at 0 and at 90 deg; one row a rotor [kg
  /// m^2].
  const Rows& momentum() const { return momentum_; }
  const Rows& raised_momentum() const { return raised_momentum_; }

 private:
  void add(const Gyro& gyro);

  std::vector<Gyro> gyros_;
  Rows pivots_ = Rows::Zero(), axes_ = Rows::Zero(), raised_axes_ = Rows::Zero();
  double mass_ = 0.0;
  double inertia_ = 0.0;
  Terms terms_;
  Rows momentum_ = Rows::Zero(), raised_momentum_ = Rows::Zero();
};

}  // namespace gyrotwin::model
