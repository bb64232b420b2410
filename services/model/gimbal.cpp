#include "services/model/gimbal.hpp"

namespace gyrotwin::model {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Symmetric3<double> packed(const Matrix3d& A) {
  Symmetric3<double> packed;
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

void MassMoments::add(const MassMoments& other) {
  mass += other.mass;
  first += other.first;
  second += other.second;
}

MassMoments moments_of(double mass, const Vector3d& cm, const Vector3d& inertia) {
  const Matrix3d second = Matrix3d(inertia.asDiagonal()) + mass * steiner(cm);
  return {mass, mass * cm, packed(second)};
}

Gimbal::Gimbal(int carrier, int coordinate, std::vector<Gyro> gyros)
    : carrier_(carrier), coordinate_(coordinate), gyros_(std::move(gyros)) {
  for (const Gyro& gyro : gyros_) add(gyro);
}

/// With s = axis cos q + raised sin q the cm is at pivot + d s, and the inertia about it is
/// It 1 + (Ix - It) s s'.
void Gimbal::add(const Gyro& g) {
  const Vector3d hinge = g.axis.cross(g.raised);
  const Vector3d& r = g.pivot;
  const double d = g.cm_distance, md = g.mass * d;
  const double about_hinge = g.planar_inertia + md * d;
  inertia_ += about_hinge;

  fixed_.mass += g.mass;
  fixed_.first += g.mass * r;
  first_.cosine += md * g.axis;
  first_.sine += md * g.raised;

  // r x m d s' and the turning itself, about the hinge.
  swing_fixed_ += about_hinge * hinge;
  swing_.cosine += md * r.cross(g.raised);
  swing_.sine -= md * r.cross(g.axis);

  const auto mixed = [&](const Vector3d& s) -> Matrix3d {
    return md * (2.0 * r.dot(s) * Matrix3d::Identity() - twice_symmetric(r, s));
  };
  const double k = 0.5 * (g.axial_inertia - about_hinge);
  const Matrix3d aa = g.axis * g.axis.transpose(), bb = g.raised * g.raised.transpose();
  fixed_.second += packed(about_hinge * Matrix3d::Identity() + g.mass * steiner(r) + k * (aa + bb));
  second_.cosine += packed(mixed(g.axis));
  second_.sine += packed(mixed(g.raised));
  second_twice_.cosine += packed(k * (aa - bb));
  second_twice_.sine += packed(k * twice_symmetric(g.axis, g.raised));
}

template <class S>
GimbalShareOf<S> Gimbal::at(const S& c, const S& s, const Rotors& rotors) const noexcept {
  const S c2 = c * c - s * s, s2 = 2.0 * c * s;
  Vector3d h_axis = Vector3d::Zero(), h_raised = Vector3d::Zero();
  Vector3d rate_axis = Vector3d::Zero(), rate_raised = Vector3d::Zero();
  for (const Gyro& g : gyros_) {
    const double h = g.rotor_inertia * rotors.speed[g.rotor_index];
    const double h_rate = g.rotor_inertia * rotors.rate[g.rotor_index];
    h_axis += h * g.axis;
    h_raised += h * g.raised;
    rate_axis += h_rate * g.axis;
    rate_raised += h_rate * g.raised;
  }

  GimbalShareOf<S> share;
  share.first = c * first_.cosine + s * first_.sine;
  share.first_q = c * first_.sine - s * first_.cosine;
  share.swing = swing_fixed_ + (c * swing_.cosine + s * swing_.sine);
  share.swing_q = c * swing_.sine - s * swing_.cosine;
  share.second = c * second_.cosine + s * second_.sine +  //
                 c2 * second_twice_.cosine + s2 * second_twice_.sine;
  share.second_q = c * second_.sine - s * second_.cosine +  //
                   (2.0 * c2) * second_twice_.sine - (2.0 * s2) * second_twice_.cosine;
  share.h = c * h_axis + s * h_raised;
  share.h_q = c * h_raised - s * h_axis;
  share.h_t = c * rate_axis + s * rate_raised;
  return share;
}

template GimbalShareOf<double> Gimbal::at(const double&, const double&,
                                          const Rotors&) const noexcept;
template GimbalShareOf<Dual> Gimbal::at(const Dual&, const Dual&, const Rotors&) const noexcept;

}  // namespace gyrotwin::model
