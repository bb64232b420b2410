// The gyrostat tree: the one formulation of all machines. Derivation: README.md, section 2.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "services/model/gimbal.hpp"

namespace gyrotwin::model {

inline constexpr int kMaxCoordinates = 6;
inline constexpr int kMaxBodies = 2;

/// "No body": the ground as a parent. "No coordinate": a rotation by a constant angle.
inline constexpr int kGround = -1;
inline constexpr int kFixed = -1;

/// Generalised coordinates or rates; entries beyond the machine's coordinates are 0.
template <class S>
using CoordinatesOf = Eigen::Matrix<S, kMaxCoordinates, 1>;
using Coordinates = CoordinatesOf<double>;
template <class S>
using MassMatrixOf = Eigen::Matrix<S, kMaxCoordinates, kMaxCoordinates>;
using MassMatrix = MassMatrixOf<double>;

enum class Axis : std::uint8_t { kX = 0, kY = 1, kZ = 2 };

/// A turn by `offset + sense * q[coordinate]` [rad] about an axis of the frame reached so far.
struct Rotation {
  Axis axis = Axis::kZ;
  int coordinate = kFixed;
  double sense = 1.0;  ///< 1 or -1
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
  MassMatrixOf<S> M;   ///< symmetric, only the lower triangle is filled
  CoordinatesOf<S> f;  ///< inertial, gyroscopic and gravity terms [N m]
};
using Motion = MotionOf<double>;

/// Bodies joined by revolute joints whose angles are coordinates, and gyros on gimbals that the
/// bodies carry.
class Tree {
 public:
  /// Parents must come before their children.
  /// @throws std::invalid_argument naming the body or gimbal that breaks this or a capacity.
  Tree(std::vector<Body> bodies, std::vector<Gimbal> gimbals, int coordinates);

  int coordinates() const { return n_; }
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Gimbal>& gimbals() const { return gimbals_; }

  /// Of a body with its gyros [kg].
  double mass(int body) const { return resolved_[body].moments.mass; }
  /// Of a rotor about its axis [kg m^2].
  double rotor_inertia(int rotor) const { return rotor_inertia_[rotor]; }

  /// Coordinates that move a body's pivot / turn the body.
  const IndexList& linear(int body) const { return resolved_[body].linear; }
  const IndexList& angular(int body) const { return resolved_[body].angular; }

  /// Fills `motion` at (q, v) [rad, rad/s]. Does not allocate.
  template <class S>
  void evaluate(const CoordinatesOf<S>& q, const CoordinatesOf<S>& v, const Rotors& rotors,
                const Support& support, MotionOf<S>& motion) const noexcept;

 private:
  struct ResolvedRotation {
    Axis axis;
    int coordinate;
    double sense;
    double sin, cos;  // of the offset
  };
  struct ResolvedBody {
    IndexList linear, angular;
    std::array<ResolvedRotation, 4> rotation;
    int rotations = 0;
    MassMoments moments;  // with what of its gyros does not vary
  };
  void resolve(int b);
  void carry(const Gimbal& gimbal);
  template <class S>
  void move(int b, const CoordinatesOf<S>& v, const Support& support,
            MotionOf<S>& motion) const noexcept;
  template <class S>
  void load(int b, const CoordinatesOf<S>& v, const Rotors& rotors,
            MotionOf<S>& motion) const noexcept;

  std::vector<Body> bodies_;
  std::vector<Gimbal> gimbals_;
  std::array<ResolvedBody, kMaxBodies> resolved_;
  RotorSpeeds rotor_inertia_{};
  int n_;
};

/// Solves M x = b for the leading n x n block, M symmetric positive definite in its lower triangle
/// (Cholesky). Not positive definite: the result is not finite.
template <class S>
CoordinatesOf<S> solve(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b, int n) noexcept;

}  // namespace gyrotwin::model
