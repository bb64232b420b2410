#include "services/model/tree.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

IndexList list_of(unsigned mask) {
  IndexList list;
  for (std::uint8_t i = 0; i < kMaxCoordinates; ++i) {
    if (mask & (1u << i)) list.index[list.size++] = i;
  }
  return list;
}

/// sum += a x b, by components: Eigen writes the product by components too, and reading it back in
/// pairs stalls.
template <class S>
void add_cross(Vector3<S>& sum, const Vector3<S>& a, const Vector3<S>& b) {
  sum.x() += a.y() * b.z() - a.z() * b.y();
  sum.y() += a.z() * b.x() - a.x() * b.z();
  sum.z() += a.x() * b.y() - a.y() * b.x();
}

/// R <- R Rot(axis, angle): only two columns change.
template <class S>
void turn(Eigen::Matrix<S, 3, 3>& R, Axis axis, S s, S c) {
  const int a = (static_cast<int>(axis) + 1) % 3;
  const int b = (static_cast<int>(axis) + 2) % 3;
  const Vector3<S> A = R.col(a);
  const Vector3<S> B = R.col(b);
  R.col(a) = c * A + s * B;
  R.col(b) = c * B - s * A;
}

}  // namespace

Tree::Tree(std::vector<Body> bodies, int coordinates)
    : bodies_(std::move(bodies)), n_(coordinates) {
  if (n_ < 1 || n_ > kMaxCoordinates) throw std::invalid_argument("tree: 1 to 6 coordinates");
  if (bodies_.size() > kMaxBodies) throw std::invalid_argument("tree: at most 6 bodies");
  std::array<unsigned, kMaxBodies> linear{}, angular{};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const auto name = "tree: body " + std::to_string(b);
    const int here = static_cast<int>(b);
    if (body.position_parent >= here || body.orientation_parent >= here) {
      throw std::invalid_argument(name + ": parents must come first");
    }
    ResolvedBody& resolved = resolved_[b];
    if (body.rotations.size() > resolved.rotation.size()) {
      throw std::invalid_argument(name + ": at most 4 rotations");
    }
    if (body.rotor_index >= kMaxRotors) throw std::invalid_argument(name + ": no such rotor");
    if (body.position_parent != kGround) {
      linear[b] = linear[body.position_parent];
      if (!body.pivot.isZero(0)) linear[b] |= angular[body.position_parent];
    }
    if (body.orientation_parent != kGround) angular[b] = angular[body.orientation_parent];
    for (const Rotation& r : body.rotations) {
      if (r.coordinate >= n_) throw std::invalid_argument(name + ": no such coordinate");
      if (r.coordinate != kFixed) angular[b] |= 1u << r.coordinate;
      resolved.rotation[resolved.rotations++] = {r.axis,   r.coordinate,       r.coefficient,
                                                 r.offset, std::sin(r.offset), std::cos(r.offset)};
    }
    resolved.cm_at_pivot = body.cm.isZero(0);
    resolved.linear = list_of(linear[b]);
    resolved.angular = list_of(angular[b]);
    resolved.only_angular = list_of(angular[b] & ~linear[b]);
    resolved.linear_cm = list_of(resolved.cm_at_pivot ? linear[b] : linear[b] | angular[b]);
  }
}

template <class S>
void Tree::evaluate(const CoordinatesOf<S>& q, const CoordinatesOf<S>& v,
                    const RotorSpeeds& rotor_speed, const Support& support,
                    MotionOf<S>& motion) const noexcept {
  using std::cos, std::sin;
  motion.M.setZero();
  motion.f.setZero();

  // Gears share coordinates, so one sine and cosine per coordinate serves all unit gearings.
  std::array<S, kMaxCoordinates> sin_q, cos_q;
  for (int i = 0; i < n_; ++i) {
    sin_q[i] = sin(q[i]);
    cos_q[i] = cos(q[i]);
  }

  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const ResolvedBody& resolved = resolved_[b];
    FrameOf<S>& frame = motion.frame[b];

    // The pivot, carried by the position parent.
    for (int i : resolved.linear) frame.Jv[i].setZero();
    if (body.position_parent == kGround) {
      frame.p.setZero();
      frame.v.setZero();
      frame.a0 = support.acceleration.cast<S>();
    } else {
      const FrameOf<S>& parent = motion.frame[body.position_parent];
      const Vector3<S> rho = parent.R * body.pivot;
      frame.p = parent.p + rho;
      const Vector3<S> v_rho = parent.omega.cross(rho);
      frame.v = parent.v + v_rho;
      frame.a0 = parent.a0;
      add_cross(frame.a0, parent.alpha0, rho);
      add_cross(frame.a0, parent.omega, v_rho);
      for (int i : linear(body.position_parent)) frame.Jv[i] = parent.Jv[i];
      for (int i : angular(body.position_parent)) {
        add_cross(frame.Jv[i], parent.Jw[i], rho);
      }
    }

    // The orientation, turned from the orientation parent's by the joint's rotations.
    for (int i : resolved.angular) frame.Jw[i].setZero();
    if (body.orientation_parent != kGround) {
      const FrameOf<S>& parent = motion.frame[body.orientation_parent];
      frame.R = parent.R;
      frame.omega = parent.omega;
      frame.alpha0 = parent.alpha0;
      for (int i : angular(body.orientation_parent)) frame.Jw[i] = parent.Jw[i];
    } else {
      frame.R.setIdentity();
      frame.omega = {S(0.0), S(0.0), S(support.yaw_rate)};
      frame.alpha0.setZero();
    }
    for (int r = 0; r < resolved.rotations; ++r) {
      const ResolvedRotation& rotation = resolved.rotation[r];
      S s = rotation.sin, c = rotation.cos;
      if (rotation.coordinate != kFixed) {
        const int i = rotation.coordinate;
        const double k = rotation.coefficient;
        const Vector3<S> e = frame.R.col(static_cast<int>(rotation.axis));
        const Vector3<S> rate = k * v[i] * e;
        add_cross(frame.alpha0, frame.omega, rate);
        frame.omega += rate;
        frame.Jw[i] += k * e;
        if (rotation.offset == 0.0 && (k == 1.0 || k == -1.0)) {
          s = k * sin_q[i];
          c = cos_q[i];
        } else {
          s = sin(rotation.offset + k * q[i]);
          c = cos(rotation.offset + k * q[i]);
        }
      }
      turn(frame.R, rotation.axis, s, c);
    }

    // Linear inertia, weight in it, at the centre of mass.
    JacobianOf<S> at_cm;
    const JacobianOf<S>& Jv = resolved.cm_at_pivot ? frame.Jv : at_cm;
    Vector3<S> a0 = frame.a0;
    motion.p_cm[b] = frame.p;
    motion.v_cm[b] = frame.v;
    if (!resolved.cm_at_pivot) {
      const Vector3<S> rho = frame.R * body.cm;
      const Vector3<S> v_rho = frame.omega.cross(rho);
      motion.p_cm[b] += rho;
      motion.v_cm[b] += v_rho;
      add_cross(a0, frame.alpha0, rho);
      add_cross(a0, frame.omega, v_rho);
      for (int i : resolved.linear) at_cm[i] = frame.Jv[i];
      for (int i : resolved.only_angular) at_cm[i].setZero();
      for (int i : resolved.angular) add_cross(at_cm[i], frame.Jw[i], rho);
    }
    for (int i : resolved.linear_cm) {
      const Vector3<S> m_Jv = body.mass * Jv[i];
      motion.f[i] -= m_Jv.dot(a0);
      for (int j : resolved.linear_cm) {
        if (j > i) break;
        motion.M(i, j) += m_Jv.dot(Jv[j]);
      }
    }

    // Angular inertia and gyroscopic moment, in body axes where the inertia is diagonal.
    motion.h[b] = body.rotor_index < 0 ? Vector3d::Zero()
                                       : Vector3d(body.rotor * rotor_speed[body.rotor_index]);
    const Vector3<S> omega = frame.R.transpose() * frame.omega;
    const Vector3<S> alpha0 = frame.R.transpose() * frame.alpha0;
    const Vector3<S> moment = body.inertia.cwiseProduct(alpha0) +
                              omega.cross(body.inertia.cwiseProduct(omega) + motion.h[b]);
    JacobianOf<S> Jw;
    for (int i : resolved.angular) Jw[i] = frame.R.transpose() * frame.Jw[i];
    for (int i : resolved.angular) {
      const Vector3<S> I_Jw = body.inertia.cwiseProduct(Jw[i]);
      motion.f[i] -= Jw[i].dot(moment);
      for (int j : resolved.angular) {
        if (j > i) break;
        motion.M(i, j) += I_Jw.dot(Jw[j]);
      }
    }
  }
}

template <class S>
CoordinatesOf<S> solve(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b, int n) noexcept {
  // M = L D L', L with a unit diagonal: no square roots, and one division a coordinate.
  MassMatrixOf<S> L;   // its strict lower triangle
  MassMatrixOf<S> LD;  // the same columns times D
  std::array<S, kMaxCoordinates> inverse_D;
  CoordinatesOf<S> x = CoordinatesOf<S>::Zero();
  for (int i = 0; i < n; ++i) {
    S d = M(i, i);
    S y = b[i];
    for (int j = 0; j < i; ++j) {
      S sum = M(i, j);
      for (int k = 0; k < j; ++k) sum -= LD(i, k) * L(j, k);
      LD(i, j) = sum;
      L(i, j) = sum * inverse_D[j];
      d -= sum * L(i, j);
      y -= L(i, j) * x[j];
    }
    inverse_D[i] = d > 0.0 ? S(1.0 / d) : S(std::numeric_limits<double>::quiet_NaN());
    x[i] = y;
  }
  for (int i = n - 1; i >= 0; --i) {
    x[i] *= inverse_D[i];
    for (int k = i + 1; k < n; ++k) x[i] -= L(k, i) * x[k];
  }
  return x;
}

template void Tree::evaluate(const Coordinates&, const Coordinates&, const RotorSpeeds&,
                             const Support&, Motion&) const noexcept;
template void Tree::evaluate(const CoordinatesOf<Dual>&, const CoordinatesOf<Dual>&,
                             const RotorSpeeds&, const Support&, MotionOf<Dual>&) const noexcept;
template Coordinates solve(const MassMatrix&, const Coordinates&, int) noexcept;
template CoordinatesOf<Dual> solve(const MassMatrixOf<Dual>&, const CoordinatesOf<Dual>&,
                                   int) noexcept;

}  // namespace gyrotwin::model
