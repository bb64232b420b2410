// M and f of a tree, written out for its shape. Derivation: README.md, section 2.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "services/model/share.hpp"
#include "services/model/sine_cosine.hpp"
#include "services/model/tree.hpp"
#include "services/model/unroll.hpp"

namespace gyrotwin::model {

// Unnamed: who writes a shape out gets it as he compiles it, and nobody else does.
namespace {

/// One evaluation for one shape: every index is a constant, and all is inlined into one function,
/// so that what one body's part leaves at 0 is known to be 0 in the next.
template <Shape shape, class S>
class Evaluator {
 public:
  Evaluator(const Tree& tree, const CoordinatesOf<S>& v, const Rotors& rotors, MotionOf<S>& motion)
      : tree_(tree), v_(v), rotors_(rotors), motion_(motion) {}

  void run(const CoordinatesOf<S>& q, const Support& support) {
    static_assert(in_pairs(kMaxCoordinates) == kMaxCoordinates);
    sine_cosine<shape.coordinates>(q.data(), motion_.sin_q.data(), motion_.cos_q.data());
    motion_.f.setZero();
    count_to<shape.coordinates>([&](auto i) {
      for (int j = 0; j <= i; ++j) M(i, j) = 0.0;
    });
    count_to<shape.bodies.size>([&](auto b) {
      turn<b>(support);
      place<b>(support);
      load<b>();
    });
  }

 private:
  /// sum += a x b, by components: Eigen writes the product by components too, and reading it back
  /// in pairs stalls.
  static void add_cross(Vector3<S>& sum, const Vector3<S>& a, const Vector3<S>& b) {
    sum.x() += a.y() * b.z() - a.z() * b.y();
    sum.y() += a.z() * b.x() - a.x() * b.z();
    sum.z() += a.x() * b.y() - a.y() * b.x();
  }

  /// The element in the lower triangle.
  S& M(int i, int j) { return motion_.M(std::max(i, j), std::min(i, j)); }

  /// The orientation, turned from the orientation parent's by the joint's rotations.
  template <int b>
  void turn(const Support& support) {
    constexpr Shape::Joint joint = shape.bodies[b];
    FrameOf<S>& frame = motion_.frame[b];
    Matrix3<S> turned = Matrix3<S>::Identity();
    if constexpr (joint.orientation_parent == kGround) {
      frame.omega = {S(0.0), S(0.0), S(support.yaw_rate)};
      frame.alpha0.setZero();
    } else {
      const FrameOf<S>& parent = motion_.frame[joint.orientation_parent];
      frame.omega = parent.omega;
      frame.alpha0 = parent.alpha0;
      each<joint.inherited()>([&](auto i) { frame.Jw[i] = parent.Jw[i]; });
    }
    count_to<joint.rotations.size>([&](auto r) { turn<b, r>(turned); });

    if constexpr (joint.position_parent == kGround) {
      frame.R = turned;
    } else {
      const Matrix3<S>& R_parent = motion_.frame[joint.position_parent].R;
      constexpr bool by_ground = joint.orientation_parent == kGround;
      frame.R = by_ground ? turned : Matrix3<S>(R_parent * turned);
      frame.R_carrier = by_ground ? Matrix3<S>(R_parent.transpose() * turned) : turned;
    }
  }

  /// R <- R Rot, and x <- Rot' x for omega, alpha0 and Jw.
  template <int b, int r>
  void turn(Matrix3<S>& R) {
    constexpr Shape::Joint joint = shape.bodies[b];
    constexpr Rotation rotation = joint.rotations[r];
    constexpr int k = rotation.coordinate, e = static_cast<int>(rotation.axis);
    constexpr int e1 = (e + 1) % 3, e2 = (e + 2) % 3;
    const S c = motion_.cos_q[k], s = rotation.sense * motion_.sin_q[k];
    FrameOf<S>& frame = motion_.frame[b];
    const auto resolve = [&](Vector3<S>& x) {
      const S x1 = x[e1], x2 = x[e2];
      x[e1] = c * x1 + s * x2;
      x[e2] = c * x2 - s * x1;
    };
    const Vector3<S> R1 = R.col(e1), R2 = R.col(e2);
    R.col(e1) = c * R1 + s * R2;
    R.col(e2) = c * R2 - s * R1;
    resolve(frame.omega);
    resolve(frame.alpha0);
    each<joint.inherited()>([&](auto j) { resolve(frame.Jw[j]); });
    count_to<r>([&](auto before) { resolve(frame.Jw[joint.rotations[before].coordinate]); });

    // alpha <- alpha + omega x (q' e), omega <- omega + q' e, Jw = e.
    const S rate = rotation.sense * v_[k];
    frame.alpha0[e1] += frame.omega[e2] * rate;
    frame.alpha0[e2] -= frame.omega[e1] * rate;
    frame.omega[e] += rate;
    frame.Jw[k].setZero();
    frame.Jw[k][e] = rotation.sense;
  }

  /// The pivot's motion, which the position parent gives it.
  template <int b>
  void place(const Support& support) {
    constexpr Shape::Joint joint = shape.bodies[b];
    FrameOf<S>& frame = motion_.frame[b];
    if constexpr (joint.position_parent == kGround) {
      frame.a0 = frame.R.transpose() * support.acceleration.cast<S>();
    } else {
      constexpr Shape::Joint carrier = shape.bodies[joint.position_parent];
      const FrameOf<S>& parent = motion_.frame[joint.position_parent];
      const Vector3<S> rho = sparse<joint.pivot>(tree_.bodies()[b].pivot).template cast<S>();
      Vector3<S> v_rho = Vector3<S>::Zero(), a = parent.a0;
      add_cross(v_rho, parent.omega, rho);
      add_cross(a, parent.alpha0, rho);
      add_cross(a, parent.omega, v_rho);
      frame.a0 = frame.R_carrier.transpose() * a;
      each<joint.linear>([&](auto i) {
        Vector3<S> J = Vector3<S>::Zero();
        if constexpr (carrier.linear.has(i)) J = parent.Jv[i];
        if constexpr (carrier.angular.has(i)) add_cross(J, parent.Jw[i], rho);
        frame.Jv[i] = frame.R_carrier.transpose() * J;
      });
    }
  }

  /// What a body with its gyros adds to M and f; all about its pivot.
  template <int b>
  void load() {
    constexpr Shape::Joint joint = shape.bodies[b];
    const FrameOf<S>& frame = motion_.frame[b];
    const Vector3<S>&omega = frame.omega, &a = frame.a0, &alpha = frame.alpha0;
    const JacobianOf<S>&Jv = frame.Jv, &Jw = frame.Jw;
    MomentaOf<S>& momenta = motion_.momenta[b];

    // F and N, the force and the moment that the accelerations at q'' = 0 take.
    const double m = tree_.mass(b);
    Moments<S> moments;
    moments.add(S(1.0), sparse<fixed_pattern(shape, b)>(tree_.moments(b)));
    Vector3<S> F = m * a;
    Vector3<S> N = Vector3<S>::Zero();
    momenta.swing.setZero();
    momenta.angular.setZero();
    momenta.rotors.setZero();
    if constexpr (joint.has_rotor) {
      const Body& body = tree_.bodies()[b];
      momenta.rotors = (body.rotor * rotors_.speed[body.rotor_index]).template cast<S>();
      N += body.rotor * rotors_.rate[body.rotor_index];
    }
    count_to<shape.gimbals.size>([&](auto g) {
      if constexpr (shape.gimbals[g].carrier == b) {
        constexpr int k = shape.gimbals[g].coordinate;
        const Gimbal& gimbal = tree_.gimbals()[g];
        const S rate = v_[k];
        const GimbalShare<S> share =
            share_of<shape.gimbals[g].gyros>(gimbal, motion_.cos_q[k], motion_.sin_q[k], rotors_);
        const Vector3<S> turning = share.moments_q.second_times(omega);
        moments.add(share.moments);
        momenta.swing += rate * share.moments_q.first;
        momenta.angular += rate * share.swing;
        momenta.rotors += share.h;
        F -= (rate * rate) * share.moments.first;
        N += rate * (turning + share.h_q) + share.h_t + (rate * rate) * share.swing_q;
        motion_.f[k] += omega.dot(Vector3<S>(0.5 * turning + share.h_q)) -
                        share.moments_q.first.dot(a) - share.swing.dot(alpha);
        M(k, k) += gimbal.inertia();
        each<joint.linear>([&](auto i) { M(k, i) += share.moments_q.first.dot(Jv[i]); });
        each<joint.angular>([&](auto i) { M(k, i) += share.swing.dot(Jw[i]); });
      }
    });
    momenta.first_moment = moments.first;
    momenta.angular += moments.second_times(omega) + momenta.rotors;
    N += moments.second_times(alpha) + moments.first.cross(a);
    add_cross(N, omega, momenta.angular);
    F -= moments.first.cross(alpha);
    add_cross(F, omega, 2.0 * momenta.swing - moments.first.cross(omega));

    // M_ij += Jv_i . p_j + Jw_i . l_j with the momenta p_j, l_j that a unit rate of q_j gives.
    each<joint.linear>([&](auto i) {
      const Vector3<S> m_Jv = m * Jv[i];
      const Vector3<S> moment = moments.first.cross(Jv[i]);
      motion_.f[i] -= Jv[i].dot(F);
      each<joint.linear>([&](auto j) {
        if constexpr (j <= i) M(i, j) += m_Jv.dot(Jv[j]);
      });
      each<joint.angular>([&](auto j) {
        const S once = moment.dot(Jw[j]);
        M(i, j) += i == j ? S(2.0 * once) : once;
      });
    });
    each<joint.angular>([&](auto i) {
      const Vector3<S> I_Jw = moments.second_times(Jw[i]);
      motion_.f[i] -= Jw[i].dot(N);
      each<joint.angular>([&](auto j) {
        if constexpr (j <= i) M(i, j) += I_Jw.dot(Jw[j]);
      });
    });
  }

  const Tree& tree_;
  const CoordinatesOf<S>& v_;
  const Rotors& rotors_;
  MotionOf<S>& motion_;
};

/// x of M x = b for a shape's M, of which only the elements are used that the shape couples. From
/// the last coordinate to the first M = L' D L, L with a unit diagonal: no square roots, one
/// division each.
template <Shape shape, class S>
class Solver {
 public:
  static CoordinatesOf<S> solve(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b) {
    constexpr int n = shape.coordinates;
    std::array<std::array<S, n>, n> L;  // its strict lower triangle, M's lower triangle before
    std::array<S, n> inverse_D;
    CoordinatesOf<S> x = CoordinatesOf<S>::Zero();
    count_to<n>([&](auto i) {
      x[i] = b[i];
      L[i][i] = M(+i, +i);
      coupled<i>([&](auto j) { L[i][j] = M(+i, +j); });
    });
    count_to<n>([&](auto back) {
      constexpr int k = n - 1 - back;
      const S d = L[k][k];
      inverse_D[k] = d > 0.0 ? S(1.0 / d) : S(std::numeric_limits<double>::quiet_NaN());
      coupled<k>([&](auto i) {
        const S scaled = L[k][i] * inverse_D[k];
        L[i][i] -= scaled * L[k][i];
        coupled<i>([&](auto j) {
          if constexpr (kCoupling.has(k, j)) L[i][j] -= L[k][i] * L[k][j];
        });
        x[i] -= scaled * x[k];
        L[k][i] = scaled;
      });
    });
    count_to<n>([&](auto k) {
      x[k] *= inverse_D[k];
      coupled<k>([&](auto i) { x[k] -= L[k][i] * x[i]; });
    });
    return x;
  }

 private:
  static constexpr Coupling kCoupling = coupling_of(shape);

  /// Calls f with the coordinates before i that it is coupled with.
  template <int i, class F>
  static void coupled(const F& f) {
    count_to<i>([&](auto j) {
      if constexpr (kCoupling.has(i, j)) f(j);
    });
  }
};

/// For a tree of that shape.
template <Shape shape, class S>
void evaluate_as(const Tree& tree, const CoordinatesOf<S>& q, const CoordinatesOf<S>& v,
                 const Rotors& rotors, const Support& support, MotionOf<S>& motion) noexcept {
  Evaluator<shape, S>(tree, v, rotors, motion).run(q, support);
}

template <Shape shape, class S>
CoordinatesOf<S> solve_as(const MassMatrixOf<S>& M, const CoordinatesOf<S>& b) noexcept {
  return Solver<shape, S>::solve(M, b);
}

/// The tree of that shape.
/// @throws std::invalid_argument when bodies and gimbals are not as the shape says
template <Shape shape>
Tree make_tree(std::vector<Body> bodies, std::vector<Gimbal> gimbals) {
  const Tree::Equations<double> equations{evaluate_as<shape, double>, solve_as<shape, double>};
  const Tree::Equations<Dual> with_slopes{evaluate_as<shape, Dual>, solve_as<shape, Dual>};
  return Tree(shape, {equations, with_slopes}, std::move(bodies), std::move(gimbals));
}

}  // namespace
}  // namespace gyrotwin::model
