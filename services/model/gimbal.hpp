// Gyros that turn on a body, and what they add to its inertia. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "services/model/dual.hpp"
#include "services/model/shape.hpp"

namespace gyrotwin::model {

using RotorSpeeds = std::array<double, kMaxRotors>;

/// The rotors' speeds relative to their frames.
struct Rotors {
  RotorSpeeds speed;   ///< n [rad/s]
  RotorSpeeds rate{};  ///< n' [rad/s^2]
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
  Vector3<S> first_vector() const { return first; }
  S first_dot(const Vector3<S>& x) const { return first.dot(x); }
  Vector3<S> first_cross(const Vector3<S>& x) const { return first.cross(x); }
  Vector3<S> second_times(const Vector3<S>& x) const {
    const auto& J = second;
    return {J[0] * x[0] + J[3] * x[1] + J[4] * x[2], J[3] * x[0] + J[1] * x[1] + J[5] * x[2],
            J[4] * x[0] + J[5] * x[1] + J[2] * x[2]};
  }
};

/// The same of a balanced body: the first along z, the second diagonal.
template <class S>
struct BalancedMoments {
  S first = S(0.0);
  Vector3<S> second = Vector3<S>::Zero();

  void add(const S& k, const Moments<double>& other) {
    first += k * other.first.z();
    second += k * other.second.template head<3>();
  }
  void add(const BalancedMoments& other) {
    first += other.first;
    second += other.second;
  }
  Vector3<S> first_vector() const { return {S(0.0), S(0.0), first}; }
  S first_dot(const Vector3<S>& x) const { return first * x[2]; }
  Vector3<S> first_cross(const Vector3<S>& x) const {
    return {-first * x[1], first * x[0], S(0.0)};
  }
  Vector3<S> second_times(const Vector3<S>& x) const { return second.cwiseProduct(x); }
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

/// What a gimbal adds to its carrier at one angle; x_q is dx/dq. About the carrier's pivot, in its
/// axes.
template <class S, class AnyMoments>
struct GimbalShare {
  AnyMoments moments, moments_q;  ///< of the moments the part that varies
  Vector3<S> swing, swing_q;      ///< angular momentum of a unit rate of q [kg m^2]
  Vector3<S> h, h_q, h_t;         ///< rotor momentum [N m s], and by time
};

/// Gyros that turn on one body by one angle q, geared 1 : 1 or 1 : -1. All that they add to the
/// body's inertia is a trigonometric polynomial in q, however many they are.
class Gimbal {
 public:
  using Rows = Eigen::Array<double, kMaxRotors, 3>;

  /// @throws std::invalid_argument for more than 4 gyros
  explicit Gimbal(std::vector<Gyro> gyros);

  const std::vector<Gyro>& gyros() const { return gyros_; }
  /// Their pivots and axes, one row a gyro.
  const Rows& pivots() const { return pivots_; }
  const Rows& axes() const { return axes_; }
  const Rows& raised_axes() const { return raised_axes_; }

  double mass() const { return mass_; }
  /// What of the gyros' moments does not depend on q.
  const Moments<double>& fixed() const { return fixed_; }
  /// Of all gyros about their hinges [kg m^2].
  double inertia() const { return inertia_; }
  /// Whether the gyros leave a balanced body balanced and have no swing; but for rounding.
  bool balanced() const;

  /// @tparam AnyMoments Moments<S>, or BalancedMoments<S> without the swing
  /// @param c, s cosine and sine of q
  template <class AnyMoments, class S>
  GimbalShare<S, AnyMoments> at(const S& c, const S& s, const Rotors& rotors) const noexcept;

 private:
  void add(const Gyro& gyro);

  std::vector<Gyro> gyros_;
  Rows pivots_ = Rows::Zero(), axes_ = Rows::Zero(), raised_axes_ = Rows::Zero();
  double mass_ = 0.0;
  double inertia_ = 0.0;
  // The polynomials' coefficients: of 1, cos q, sin q, cos 2q, sin 2q.
  Moments<double> fixed_, cosine_, sine_, cosine2_, sine2_;
  Eigen::Vector3d swing_fixed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d swing_cosine_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d swing_sine_ = Eigen::Vector3d::Zero();
};

template <class AnyMoments, class S>
GimbalShare<S, AnyMoments> Gimbal::at(const S& c, const S& s, const Rotors& rotors) const noexcept {
  GimbalShare<S, AnyMoments> share;
  const S c2 = c * c - s * s, s2 = 2.0 * c * s;
  share.moments.add(c, cosine_);
  share.moments.add(s, sine_);
  share.moments.add(c2, cosine2_);
  share.moments.add(s2, sine2_);
  share.moments_q.add(-s, cosine_);
  share.moments_q.add(c, sine_);
  share.moments_q.add(-2.0 * s2, cosine2_);
  share.moments_q.add(2.0 * c2, sine2_);
  share.swing = swing_fixed_ + (c * swing_cosine_ + s * swing_sine_);
  share.swing_q = c * swing_sine_ - s * swing_cosine_;

  Eigen::Vector3d h_axis = Eigen::Vector3d::Zero(), h_raised = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_axis = Eigen::Vector3d::Zero(), rate_raised = Eigen::Vector3d::Zero();
  for (const Gyro& g : gyros_) {
    const double h = g.rotor_inertia * rotors.speed[g.rotor_index];
    const double h_rate = g.rotor_inertia * rotors.rate[g.rotor_index];
    h_axis += h * g.axis;
    h_raised += h * g.raised;
    rate_axis += h_rate * g.axis;
    rate_raised += h_rate * g.raised;
  }
  share.h = c * h_axis + s * h_raised;
  share.h_q = c * h_raised - s * h_axis;
  share.h_t = c * rate_axis + s * rate_raised;
  return share;
}

}  // namespace gyrotwin::model
