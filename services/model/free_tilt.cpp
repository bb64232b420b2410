#include "services/model/free_tilt.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "services/model/eigenvalues.hpp"

namespace gyrotwin::model {

namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;

/// [[a, b], [b, d]] of 2 x 2 blocks: structure and disc.
MatrixXd blocks(const Matrix2d& a, const Matrix2d& b, const Matrix2d& d) {
  MatrixXd all(4, 4);
  all << a, b, b, d;
  return all;
}

/// What a mount leaves of the tilts (thx, thy, bx, by).
MatrixXd left_by(Mount mount) {
  if (mount == Mount::kUniversalJoint) return MatrixXd::Identity(4, 4);
  MatrixXd left = MatrixXd::Zero(4, 2);
  left.topRows(2).setIdentity();
  if (mount == Mount::kRigid) left.bottomRows(2).setIdentity();
  return left;
}

}  // namespace

FreeTilt free_tilt(const UmbrellaParameters& p, double elevation) {
  const auto& g = p.gyros;
  const double N = g.count, c = std::cos(elevation), s = std::sin(elevation);
  const double rho = g.pivot_radius + g.cm_distance * c, zc = g.pivot_height + g.cm_distance * s;
  const double hd = p.disc.joint_height, moving = p.disc.mass + N * g.mass;
  UmbrellaParameters there = p;
  there.gyros.ring_elevation = elevation;

  FreeTilt x;
  x.S1 = p.disc.mass * p.disc.cm_offset + N * g.mass * zc;
  x.U = kGravity * (p.structure.mass * p.structure.cm_height + moving * hd);
  x.P = -kGravity * x.S1;
  x.Js = Eigen::Vector2d(p.structure.inertia_x, p.structure.inertia_y).array() + moving * hd * hd;
  x.Jd = p.disc.inertia_planar + p.disc.mass * p.disc.cm_offset * p.disc.cm_offset +
         N * (g.mass * (0.5 * rho * rho + zc * zc) +
              0.5 * (g.inertia_transverse * (1.0 + s * s) + g.inertia_axial * c * c));
  x.Jz = reduce(there).C;
  x.spin = N * g.rotor_inertia * g.rotor_speed * s;
  x.hd = hd;
  return x;
}

double tilt_growth(const FreeTilt& x, Mount mount, const TiltBushing& between,
                   double ground_damping, double speed) {
  const Matrix2d one = Matrix2d::Identity();
  const Matrix2d turn{{0.0, -1.0}, {1.0, 0.0}};  // i of z = thx + i thy
  const double cr = between.rotating_damping, c = cr + between.standing_damping;
  const Matrix2d spring = between.stiffness * one - speed * cr * turn;
  const MatrixXd keep = left_by(mount);
  const auto left = [&](const MatrixXd& all) -> MatrixXd { return keep.transpose() * all * keep; };
  const MatrixXd M = left(blocks(x.Js.asDiagonal(), x.hd * x.S1 * one, x.Jd * one));
  const MatrixXd G =
      left(blocks((ground_damping + c) * one, -c * one, c * one - x.momentum(speed) * turn));
  const MatrixXd K = left(blocks(spring - x.U * one, -spring, spring + x.P * one));

  const Eigen::Index n = M.rows();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomRows(n) << -M.ldlt().solve(K), -M.ldlt().solve(G);
  return eigenvalues(A).real().maxCoeff();
}

std::optional<Precession> precession(const FreeTilt& x, double speed) {
  // Jx Jy w^4 - (L^2 - K (Jx + Jy)) w^2 + K^2 = 0
  const double K = x.U - x.P, L = x.momentum(speed);
  const Eigen::Vector2d J = x.locked_inertia();
  const double twice = L * L - K * J.sum();
  const double square = twice * twice - 4.0 * J.prod() * K * K;
  if (twice <= 0.0 || square < 0.0) return std::nullopt;
  const double fast = (twice + std::sqrt(square)) / (2.0 * J.prod());
  return Precession{std::abs(K) / std::sqrt(J.prod() * fast), std::sqrt(fast)};
}

}  // namespace gyrotwin::model
