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

bool Gimbal::lie_as(const Shape::Gyros& gyros) const {
  constexpr double kRounding = 1e-14;
  double masses = 0.0;  // at their distances
  for (const Gyro& g : gyros_) masses += g.mass * (g.pivot.norm() + std::abs(g.cm_distance));
  const double moment = kRounding * masses;
  const double inertia = kRounding * terms_.fixed.second.cwiseAbs().maxCoeff();
  const auto moments_fit = [&](const Moments<double>& x, const MomentsPattern& pattern) {
    return fits(x.first, pattern.first, moment) && fits(x.second, pattern.second, inertia);
  };
  for (const Gyro& g : gyros_) {
    const int rotor = g.rotor_index - gyros.first_rotor;
    if (rotor < 0 || rotor >= gyros.rotors || !fits(g.axis, gyros.axis, kRounding) ||
        !fits(g.raised, gyros.raised, kRounding)) {
      return false;
    }
  }
  const GimbalPattern p = pattern_of(gyros);
  return moments_fit(terms_.fixed, p.fixed) && moments_fit(terms_.cosine, p.cosine) &&
         moments_fit(terms_.sine, p.sine) && moments_fit(terms_.cosine2, p.cosine2) &&
         moments_fit(terms_.sine2, p.sine2) && fits(terms_.swing_fixed, p.swing_fixed, inertia) &&
         fits(terms_.swing_cosine, p.swing_cosine, inertia) &&
         fits(terms_.swing_sine, p.swing_sine, inertia);
}

Gimbal::Gimbal(std::vector<Gyro> gyros) : gyros_(std::move(gyros)) {
  if (gyros_.size() > kMaxRotors) throw std::invalid_argument("gimbal: at most 4 gyros");
  terms_.swing_fixed = terms_.swing_cosine = terms_.swing_sine = Vector3d::Zero();
  for (std::size_t j = 0; j < gyros_.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    pivots_.row(row) = gyros_[j].pivot.transpose();
    axes_.row(row) = gyros_[j].axis.transpose();
    raised_axes_.row(row) = gyros_[j].raised.transpose();
    if (gyros_[j].rotor_index < 0 || gyros_[j].rotor_index >= kMaxRotors) {
      throw std::invalid_argument("gimbal: no such rotor");
    }
    momentum_.row(gyros_[j].rotor_index) += gyros_[j].rotor_inertia * axes_.row(row);
    raised_momentum_.row(gyros_[j].rotor_index) += gyros_[j].rotor_inertia * raised_axes_.row(row);
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

  terms_.fixed.first += g.mass * r;
  terms_.cosine.first += md * g.axis;
  terms_.sine.first += md * g.raised;

  const auto mixed = [&](const Vector3d& s) -> Matrix3d {
    return md * (2.0 * r.dot(s) * one - twice_symmetric(r, s));
  };
  const double k = 0.5 * (g.axial_inertia - about_hinge);
  const Matrix3d aa = g.axis * g.axis.transpose(), bb = g.raised * g.raised.transpose();
  terms_.fixed.second += packed(about_hinge * one + g.mass * steiner(r) + k * (aa + bb));
  terms_.cosine.second += packed(mixed(g.axis));
  terms_.sine.second += packed(mixed(g.raised));
  terms_.cosine2.second += packed(k * (aa - bb));
  terms_.sine2.second += packed(k * twice_symmetric(g.axis, g.raised));

  // r x m d ds/dq, and the turning itself.
  terms_.swing_fixed += about_hinge * hinge;
  terms_.swing_cosine += md * r.cross(g.raised);
  terms_.swing_sine -= md * r.cross(g.axis);
}

}  // namespace gyrotwin::model
