// The gyrostat tree: the one formulation of all machines. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <tuple>
#include <vector>

#include "services/model/gimbal.hpp"

namespace gyrotwin::model {

/// "No coordinate", "no body": what a machine lacks.
inline constexpr int kFixed = -1;

/// Generalised coordinates or rates; entries beyond the machine's coordinates are 0.
template <class S>
using CoordinatesOf = Eigen::Matrix<S, kMaxCoordinates, 1>;
using Coordinates = CoordinatesOf<double>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using MassMatrixOf = Eigen::Matrix<S, kMaxCoordinates, kMaxCoordinates>;
using MassMatrix = MassMatrixOf<double>;

/// One rigid body with an optional rotor of constant direction in it; its place in the tree is its
/// Shape's to say. Body axes are its principal axes.
struct Body {
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< in the position parent's frame [m]
  double mass = 0.0;                                ///< rotor included [kg]
  Eigen::Vector3d cm = Eigen::Vector3d::Zero();  ///< centre of mass from the pivot, body axes [m]
  Eigen::Vector3d inertia =
      Eigen::Vector3d::Zero();  ///< principal, about cm, rotor included [kg m^2]
  Eigen::Vector3d rotor =
      Eigen::Vector3d::Zero();  ///< axial inertia x spin axis, body axes [kg m^2]
  int rotor_index = -1;         ///< which rotor speed drives it, where its shape has a rotor
};

template <class S>
using JacobianOf = std::array<Vector3<S>, kMaxCoordinates>;

/// What carries the tree. World axes turn with it; weight is an upward acceleration.
struct Support {
  Eigen::Vector3d acceleration;  ///< of the ground pivot, minus gravity; at rest (0, 0, g) [m/s^2]
  double yaw_rate = 0.0;         ///< about z, steady [rad/s]
};

/// Motion of one body at one instant, in its own axes; the point meant is the pivot.
template <class S>
struct FrameOf {
  Matrix3<S> R;          ///< world <- body
  Matrix3<S> R_carrier;  ///< position parent <- body, of a body that has one
  Vector3<S> omega;      ///< angular velocity, in space [rad/s]
  Vector3<S> a0;         ///< acceleration of the pivot at q'' = 0, minus gravity [m/s^2]
  Vector3<S> alpha0;     ///< angular acceleration at q'' = 0 [rad/s^2]
  JacobianOf<S> Jv;      ///< d v / d q'_i, meaningful for i in Tree::linear(body)
  JacobianOf<S> Jw;      ///< d omega / d q'_i, meaningful for i in Tree::angular(body)
};
using Frame = FrameOf<double>;

/// Momenta of one body with its gyros, about its pivot and in its axes.
template <class S>
struct MomentaOf {
  Vector3<S> first_moment;  ///< sum m r [kg m]
  Vector3<S> swing;         ///< momentum of the gyros' turning on their gimbals [kg m/s]
  Vector3<S> angular;       ///< as seen from the moving pivot [N m s]
  Vector3<S> rotors;        ///< what the rotors' speeds are of that [N m s]
};

/// What one evaluation leaves: M q'' = f + Q, and the motion it came from.
template <class S>
struct MotionOf {
  std::array<S, kMaxCoordinates> cos_q, sin_q;
  std::array<FrameOf<S>, kMaxBodies> frame;
  std::array<MomentaOf<S>, kMaxBodies> momenta;
  MassMatrixOf<S> M;   ///< symmetric; filled is the lower triangle, up to the last coordinate
  CoordinatesOf<S> f;  ///< inertial, gyroscopic and gravity terms [N m]
};
using Motion = MotionOf<double>;

/// The numbers of a machine's bodies and gyros, and the equations of their shape.
class Tree {
 public:
  /// How a shape's M and f are evaluated, and solved.
  template <class S>
  struct Equations {
    void (*evaluate)(const Tree&, const CoordinatesOf<S>& q, const CoordinatesOf<S>& v,
                     const Rotors&, const Support&, MotionOf<S>&) noexcept;
    CoordinatesOf<S> (*solve)(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b) noexcept;
  };
  using AllEquations = std::tuple<Equations<double>, Equations<Dual>>;

  /// make_tree() of evaluate.hpp knows a shape's equations.
  /// @throws std::invalid_argument when bodies and gimbals are not as the shape says
  Tree(const Shape& shape, const AllEquations& equations, std::vector<Body> bodies,
       std::vector<Gimbal> gimbals);

  int coordinates() const { return shape_.coordinates; }
  const Shape& shape() const { return shape_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Gimbal>& gimbals() const { return gimbals_; }

  /// Of a body with its gyros [kg].
  double mass(int body) const { return mass_[body]; }
  /// Of a body with what of its gyros' moments does not vary.
  const Moments<double>& moments(int body) const { return moments_[body]; }
  /// Of a rotor about its axis [kg m^2].
  double rotor_inertia(int rotor) const { return rotor_inertia_[rotor]; }

  /// Coordinates that move a body's pivot / turn the body.
  const IndexList& linear(int body) const { return shape_.bodies[body].linear; }
  const IndexList& angular(int body) const { return shape_.bodies[body].angular; }

  /// Fills `motion` at (q, v) [rad, rad/s]. Does not allocate.
  template <class S>
  void evaluate(const CoordinatesOf<S>& q, const CoordinatesOf<S>& v, const Rotors& rotors,
                const Support& support, MotionOf<S>& motion) const noexcept {
    std::get<Equations<S>>(equations_).evaluate(*this, q, v, rotors, support, motion);
  }

  /// x of M x = b, with M that evaluate() left, and what rides on body 0 besides. Where M is not
  /// positive definite the result is not finite.
  template <class S>
  CoordinatesOf<S> solve(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b) const noexcept {
    return std::get<Equations<S>>(equations_).solve(M, b);
  }

 private:
  Shape shape_;
  AllEquations equations_;
  std::vector<Body> bodies_;
  std::vector<Gimbal> gimbals_;
  std::array<double, kMaxBodies> mass_{};
  std::array<Moments<double>, kMaxBodies> moments_;
  RotorSpeeds rotor_inertia_{};
};

}  // namespace gyrotwin::model
