// The gyrostat tree: the one formulation of all machines. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "services/model/dual.hpp"

namespace gyrotwin::model {

inline constexpr int kMaxCoordinates = 6;
inline constexpr int kMaxBodies = 6;
inline constexpr int kMaxRotors = 4;

/// "No body": the ground as a parent. "No coordinate": a rotation by a constant angle.
inline constexpr int kGround = -1;
inline constexpr int kFixed = -1;

// What depends on coordinates and rates is written for a scalar S: double, or Dual for its
// derivative along a direction.
template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;

/// Generalised coordinates or rates; entries beyond the machine's coordinates are 0.
template <class S>
using CoordinatesOf = Eigen::Matrix<S, kMaxCoordinates, 1>;
using Coordinates = CoordinatesOf<double>;
template <class S>
using MassMatrixOf = Eigen::Matrix<S, kMaxCoordinates, kMaxCoordinates>;
using MassMatrix = MassMatrixOf<double>;

enum class Axis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };

/// A turn by `offset + coefficient * q[coordinate]` [rad] about an axis of the frame reached so
/// far. The coefficient is the gearing; several bodies may share a coordinate.
struct Rotation {
  Axis axis = Axis::kZ;
  int coordinate = kFixed;
  double coefficient = 1.0;
  double offset = 0.0;
};

/// One rigid body with an optional rotor of constant direction in it. Body axes are its principal
/// axes.
struct Body {
  int position_parent = kGround;                    ///< carries the pivot
  int orientation_parent = kGround;                 ///< frame the rotations start from
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< in the position parent's frame [m]
  std::vector<Rotation> rotations;                  ///< from the orientation parent to the body
  double mass = 0.0;                                ///< rotor included [kg]
  Eigen::Vector3d cm = Eigen::Vector3d::Zero();  ///< centre of mass from the pivot, body axes [m]
  Eigen::Vector3d inertia =
      Eigen::Vector3d::Zero();  ///< principal, about cm, rotor included [kg m^2]
  Eigen::Vector3d rotor =
      Eigen::Vector3d::Zero();  ///< axial inertia x spin axis, body axes [kg m^2]
  int rotor_index = -1;         ///< which rotor speed drives it; -1: no rotor
};

/// Indices of coordinates, ascending.
struct IndexList {
  std::array<std::uint8_t, kMaxCoordinates> index{};
  std::uint8_t size = 0;
  const std::uint8_t* begin() const { return index.data(); }
  const std::uint8_t* end() const { return index.data() + size; }
};

template <class S>
using JacobianOf = std::array<Vector3<S>, kMaxCoordinates>;

/// What carries the tree. World axes turn with it; weight is an upward acceleration.
struct Support {
  Eigen::Vector3d acceleration;  ///< of the ground pivot, minus gravity; at rest (0, 0, g) [m/s^2]
  double yaw_rate = 0.0;         ///< about z, steady [rad/s]
};

/// Motion of one body at one instant; world axes, the point meant is the pivot.
template <class S>
struct FrameOf {
  Eigen::Matrix<S, 3, 3> R;  ///< world <- body
  Vector3<S> p;              ///< pivot [m]
  Vector3<S> v;              ///< velocity of the pivot against the ground pivot [m/s]
  Vector3<S> omega;          ///< angular velocity, in space [rad/s]
  Vector3<S> a0;             ///< acceleration of the pivot at q'' = 0, minus gravity [m/s^2]
  Vector3<S> alpha0;         ///< angular acceleration at q'' = 0 [rad/s^2]
  JacobianOf<S> Jv;          ///< d v / d q'_i, meaningful for i in Tree::linear(body)
  JacobianOf<S> Jw;          ///< d omega / d q'_i, meaningful for i in Tree::angular(body)
};
using Frame = FrameOf<double>;

/// What one evaluation leaves: M q'' = f + Q, and the motion it came from.
template <class S>
struct MotionOf {
  std::array<FrameOf<S>, kMaxBodies> frame;
  std::array<Vector3<S>, kMaxBodies> p_cm;    ///< centres of mass, world [m]
  std::array<Vector3<S>, kMaxBodies> v_cm;    ///< their velocities [m/s]
  std::array<Eigen::Vector3d, kMaxBodies> h;  ///< rotor momentum, body axes [N m s]
  MassMatrixOf<S> M;                          ///< symmetric, only the lower triangle is filled
  CoordinatesOf<S> f;                         ///< inertial, gyroscopic and gravity terms [N m]
};
using Motion = MotionOf<double>;

using RotorSpeeds = std::array<double, kMaxRotors>;

/// Bodies joined by revolute joints whose angles are linear in the coordinates.
class Tree {
 public:
  /// Parents must come before their children.
  /// @throws std::invalid_argument naming the body that breaks this or a capacity.
  Tree(std::vector<Body> bodies, int coordinates);

  int coordinates() const { return n_; }
  const std::vector<Body>& bodies() const { return bodies_; }

  /// Coordinates that move a body's pivot / turn the body.
  const IndexList& linear(int body) const { return resolved_[body].linear; }
  const IndexList& angular(int body) const { return resolved_[body].angular; }

  /// Fills `motion` at (q, v) [rad, rad/s]; rotor speeds [rad/s], constant at the moment. Does not
  /// allocate.
  template <class S>
  void evaluate(const CoordinatesOf<S>& q, const CoordinatesOf<S>& v,
                const RotorSpeeds& rotor_speed, const Support& support,
                MotionOf<S>& motion) const noexcept;

 private:
  struct ResolvedRotation {
    Axis axis;
    int coordinate;
    double coefficient;
    double offset;
    double sin, cos;  // of the offset, for a fixed rotation
  };
  struct ResolvedBody {
    IndexList linear, angular, only_angular, linear_cm;
    std::array<ResolvedRotation, 4> rotation;
    int rotations = 0;
    bool cm_at_pivot = true;
  };
  std::vector<Body> bodies_;
  std::array<ResolvedBody, kMaxBodies> resolved_;
  int n_;
};

/// Solves M x = b for the leading n x n block, M symmetric positive definite in its lower triangle
/// (Cholesky). Not positive definite: the result is not finite.
template <class S>
CoordinatesOf<S> solve(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b, int n) noexcept;

}  // namespace gyrotwin::model
