#include "services/model/tree.hpp"

#include <algorithm>
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

unsigned mask_of(const IndexList& list) {
  unsigned mask = 0;
  for (int i : list) mask |= 1u << i;
  return mask;
}

/// sum += a x b, by components: Eigen writes the product by components too, and reading it back in
/// pairs stalls.
template <class S>
void add_cross(Vector3<S>& sum, const Vector3<S>& a, const Vector3<S>& b) {
  sum.x() += a.y() * b.z() - a.z() * b.y();
  sum.y() += a.z() * b.x() - a.x() * b.z();
  sum.z() += a.x() * b.y() - a.y() * b.x();
}

/// The element in the lower triangle.
template <class S>
S& lower(MassMatrixOf<S>& M, int i, int j) {
  return M(std::max(i, j), std::min(i, j));
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

Tree::Tree(std::vector<Body> bodies, std::vector<Gimbal> gimbals, int coordinates)
    : bodies_(std::move(bodies)), gimbals_(std::move(gimbals)), n_(coordinates) {
  if (n_ < 1 || n_ > kMaxCoordinates) throw std::invalid_argument("tree: 1 to 6 coordinates");
  if (bodies_.size() > kMaxBodies) throw std::invalid_argument("tree: at most 2 bodies");
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) resolve(b);
  for (const Gimbal& gimbal : gimbals_) carry(gimbal);
}

/// Which coordinates move a body, and its moments.
void Tree::resolve(int b) {
  const Body& body = bodies_[b];
  ResolvedBody& resolved = resolved_[b];
  const auto name = "tree: body " + std::to_string(b);
  if (body.position_parent >= b || body.orientation_parent >= b) {
    throw std::invalid_argument(name + ": parents must come first");
  }
  if (body.rotations.size() > resolved.rotation.size()) {
    throw std::invalid_argument(name + ": at most 4 rotations");
  }
  if (body.rotor_index >= kMaxRotors) throw std::invalid_argument(name + ": no such rotor");

  unsigned linear = 0, angular = 0;
  if (body.position_parent != kGround) {
    linear = mask_of(resolved_[body.position_parent].linear);
    if (!body.pivot.isZero(0)) linear |= mask_of(resolved_[body.position_parent].angular);
  }
  if (body.orientation_parent != kGround) {
    angular = mask_of(resolved_[body.orientation_parent].angular);
  }
  for (const Rotation& r : body.rotations) {
    if (r.coordinate >= n_) throw std::invalid_argument(name + ": no such coordinate");
    if (r.coordinate != kFixed) angular |= 1u << r.coordinate;
    resolved.rotation[resolved.rotations++] = {r.axis, r.coordinate, r.sense, std::sin(r.offset),
                                               std::cos(r.offset)};
  }
  resolved.linear = list_of(linear);
  resolved.angular = list_of(angular);
  resolved.moments = moments_of(body.mass, body.cm, body.inertia);
  if (body.rotor_index >= 0) rotor_inertia_[body.rotor_index] = body.rotor.norm();
}

void Tree::carry(const Gimbal& gimbal) {
  if (gimbal.carrier() < 0 || gimbal.carrier() >= static_cast<int>(bodies_.size())) {
    throw std::invalid_argument("tree: a gimbal's carrier must be a body");
  }
  ResolvedBody& carrier = resolved_[gimbal.carrier()];
  const unsigned taken = mask_of(carrier.linear) | mask_of(carrier.angular);
  if (gimbal.coordinate() < 0 || gimbal.coordinate() >= n_ ||
      (taken >> gimbal.coordinate() & 1u) != 0) {
    throw std::invalid_argument("tree: a gimbal needs a coordinate that does not move its carrier");
  }
  carrier.moments.add(gimbal.fixed());
  for (const Gyro& gyro : gimbal.gyros()) {
    if (gyro.rotor_index < 0 || gyro.rotor_index >= kMaxRotors) {
      throw std::invalid_argument("tree: a gyro has no such rotor");
    }
    rotor_inertia_[gyro.rotor_index] = gyro.rotor_inertia;
  }
}

template <class S>
void Tree::evaluate(const CoordinatesOf<S>& q, const CoordinatesOf<S>& v, const Rotors& rotors,
                    const Support& support, MotionOf<S>& motion) const noexcept {
  using std::cos, std::sin;
  motion.M.setZero();
  motion.f.setZero();
  for (int i = 0; i < n_; ++i) {
    motion.cos_q[i] = cos(q[i]);
    motion.sin_q[i] = sin(q[i]);
  }
  for (int b = 0; b < static_cast<int>(bodies_.size()); ++b) {
    move(b, v, support, motion);
    load(b, v, rotors, motion);
  }
}

/// The frame of a body from its parents'.
template <class S>
void Tree::move(int b, const CoordinatesOf<S>& v, const Support& support,
                MotionOf<S>& motion) const noexcept {
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
    for (int i : angular(body.position_parent)) add_cross(frame.Jv[i], parent.Jw[i], rho);
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
      const double k = rotation.sense;
      const Vector3<S> e = k * frame.R.col(static_cast<int>(rotation.axis));
      const Vector3<S> rate = v[i] * e;
      add_cross(frame.alpha0, frame.omega, rate);
      frame.omega += rate;
      frame.Jw[i] += e;
      s = rotation.sin * motion.cos_q[i] + rotation.cos * k * motion.sin_q[i];
      c = rotation.cos * motion.cos_q[i] - rotation.sin * k * motion.sin_q[i];
    }
    turn(frame.R, rotation.axis, s, c);
  }
}

/// What a body with its gyros adds to M and f. All about its pivot, in its axes.
template <class S>
void Tree::load(int b, const CoordinatesOf<S>& v, const Rotors& rotors,
                MotionOf<S>& motion) const noexcept {
  const ResolvedBody& resolved = resolved_[b];
  const FrameOf<S>& frame = motion.frame[b];
  MomentaOf<S>& momenta = motion.momenta[b];
  const auto turned = [&](const Vector3<S>& x) -> Vector3<S> { return frame.R.transpose() * x; };
  const Vector3<S> omega = turned(frame.omega), alpha = turned(frame.alpha0);
  const Vector3<S> a = turned(frame.a0);
  JacobianOf<S> Jv, Jw;
  for (int i : resolved.linear) Jv[i] = turned(frame.Jv[i]);
  for (int i : resolved.angular) Jw[i] = turned(frame.Jw[i]);

  // F and N, the force and the moment that the accelerations at q'' = 0 take.
  const double m = resolved.moments.mass;
  Vector3<S> first = resolved.moments.first.template cast<S>();
  Symmetric3<S> second = resolved.moments.second.template cast<S>();
  Vector3<S> F = m * a;
  Vector3<S> N = Vector3<S>::Zero();
  momenta.swing.setZero();
  momenta.angular.setZero();
  momenta.rotors.setZero();
  if (const int j = bodies_[b].rotor_index; j >= 0) {
    momenta.rotors = (bodies_[b].rotor * rotors.speed[j]).template cast<S>();
    N += bodies_[b].rotor * rotors.rate[j];
  }
  for (const Gimbal& gimbal : gimbals_) {
    if (gimbal.carrier() != b) continue;
    const int k = gimbal.coordinate();
    const S rate = v[k];
    const auto share = gimbal.at(motion.cos_q[k], motion.sin_q[k], rotors);
    const Vector3<S> turning = product(share.second_q, omega);
    first += share.first;
    second += share.second;
    momenta.swing += rate * share.first_q;
    momenta.angular += rate * share.swing;
    momenta.rotors += share.h;
    F -= (rate * rate) * share.first;
    N += rate * (turning + rate * share.swing_q + share.h_q) + share.h_t;
    motion.f[k] -= share.first_q.dot(a) + share.swing.dot(alpha) -
                   omega.dot(Vector3<S>(0.5 * turning + share.h_q));
    motion.M(k, k) += gimbal.inertia();
    for (int i : resolved.linear) lower(motion.M, k, i) += share.first_q.dot(Jv[i]);
    for (int i : resolved.angular) lower(motion.M, k, i) += share.swing.dot(Jw[i]);
  }
  momenta.first_moment = first;
  momenta.angular += product(second, omega) + momenta.rotors;
  Vector3<S> flow = 2.0 * momenta.swing;
  add_cross(flow, omega, first);
  add_cross(F, alpha, first);
  add_cross(F, omega, flow);
  N += product(second, alpha);
  add_cross(N, first, a);
  add_cross(N, omega, momenta.angular);

  for (int i : resolved.linear) {
    const Vector3<S> m_Jv = m * Jv[i];
    const Vector3<S> moment = first.cross(Jv[i]);
    motion.f[i] -= Jv[i].dot(F);
    for (int j : resolved.linear) {
      if (j > i) break;
      motion.M(i, j) += m_Jv.dot(Jv[j]);
    }
    for (int j : resolved.angular) {
      const S once = moment.dot(Jw[j]);
      lower(motion.M, i, j) += i == j ? S(2.0 * once) : once;
    }
  }
  for (int i : resolved.angular) {
    const Vector3<S> I_Jw = product(second, Jw[i]);
    motion.f[i] -= Jw[i].dot(N);
    for (int j : resolved.angular) {
      if (j > i) break;
      motion.M(i, j) += I_Jw.dot(Jw[j]);
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

template void Tree::evaluate(const Coordinates&, const Coordinates&, const Rotors&, const Support&,
                             Motion&) const noexcept;
template void Tree::evaluate(const CoordinatesOf<Dual>&, const CoordinatesOf<Dual>&, const Rotors&,
                             const Support&, MotionOf<Dual>&) const noexcept;
template Coordinates solve(const MassMatrix&, const Coordinates&, int) noexcept;
template CoordinatesOf<Dual> solve(const MassMatrixOf<Dual>&, const CoordinatesOf<Dual>&,
                                   int) noexcept;

}  // namespace gyrotwin::model
