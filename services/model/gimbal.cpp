#include "services/model/gimbal.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gyrotwin::model {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Eigen::Matrix<double, 6, 1> packed(const Matrix3d& A) {
  Eigen::Matrix<double, 6, 1> packed;
  packed << A(0, 0), A(1, 1), A(2, 2), A(0, 1), A(0, 2), A(1, 2);
  return packed;
}

/// a b' + b a'.
Matrix3d twice_symmetric(const Vector3d& a, const Vector3d& b) {
  return a * b.transpose() + b * a.transpose();
}

/// Inertia of a unit mass at r.
Matrix3d steiner(const Vector3d& r) {
  return r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
}

}  // namespace

Moments<double> moments_of(double mass, const Vector3d& cm, const Vector3d& inertia) {
  return {mass * cm, packed(Matrix3d(inertia.asDiagonal()) + mass * steiner(cm))};
}

bool Gimbal::balanced() const {
  constexpr double kRounding = 1e-14;
  const double inertia = fixed_.second.cwiseAbs().maxCoeff();
  double moment = 0.0;  // of masses at their distances
  for (const Gyro& g : gyros_) moment += g.mass * (g.pivot.norm() + std::abs(g.cm_distance));
  const auto little = [&](const Moments<double>& x) {
    return x.first.head<2>().cwiseAbs().maxCoeff() <= kRounding * moment &&
           x.second.tail<3>().cwiseAbs().maxCoeff() <= kRounding * inertia;
  };
  const double swing =
      std::max({swing_fixed_.cwiseAbs().maxCoeff(), swing_cosine_.cwiseAbs().maxCoeff(),
                swing_sine_.cwiseAbs().maxCoeff()});
  return little(fixed_) && little(cosine_) && little(sine_) && little(cosine2_) && little(sine2_) &&
         swing <= kRounding * inertia;
}

Gimbal::Gimbal(std::vector<Gyro> gyros) : gyros_(std::move(gyros)) {
  if (gyros_.size() > kMaxRotors) throw std::invalid_argument("gimbal: at most 4 gyros");
  for (std::size_t j = 0; j < gyros_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    pivots_.row(row) = gyros_[j].pivot.transpose();
    axes_.row(row) = gyros_[j].axis.transpose();
    raised_axes_.row(row) = gyros_[j].raised.transpose();
    add(gyros_[j]);
  }
}

/// With s = axis cos q + raised sin q the cm is at pivot + d s, and the inertia about it is
/// It 1 + (Ix - It) s s'.
void Gimbal::add(const Gyro& g) {
  const Matrix3d one = Matrix3d::Identity();
  const Vector3d hinge = g.axis.cross(g.raised);
  const Vector3d& r = g.pivot;
  const double md = g.mass * g.cm_distance;
  const double about_hinge = g.planar_inertia + md * g.cm_distance;
  mass_ += g.mass;
  inertia_ += about_hinge;

  fixed_.first += g.mass * r;
  cosine_.first += md * g.axis;
  sine_.first += md * g.raised;

  const auto mixed = [&](const Vector3d& s) -> Matrix3d {
    return md * (2.0 * r.dot(s) * one - twice_symmetric(r, s));
  };
  const double k = 0.5 * (g.axial_inertia - about_hinge);
  const Matrix3d aa = g.axis * g.axis.transpose(), bb = g.raised * g.raised.transpose();
  fixed_.second += packed(about_hinge * one + g.mass * steiner(r) + k * (aa + bb));
  cosine_.second += packed(mixed(g.axis));
  sine_.second += packed(mixed(g.raised));
  cosine2_.second += packed(k * (aa - bb));
  sine2_.second += packed(k * twice_symmetric(g.axis, g.raised));

  // r x m d ds/dq, and the turning itself.
  swing_fixed_ += about_hinge * hinge;
  swing_cosine_ += md * r.cross(g.raised);
  swing_sine_ -= md * r.cross(g.axis);
}

}  // namespace gyrotwin::model
