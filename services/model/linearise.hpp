#pragma once
#include "services/model/machine.hpp"
namespace gyrotwin::model {
struct Linearisation {
  Coordinates acceleration;
  Eigen::Matrix<double, kMaxCoordinates, kMaxCoordinates> dq, dv;
  Eigen::Matrix<double, kMaxCoordinates, kMaxGyros> dn;
  Eigen::Matrix<double, kMaxCoordinates, kMaxDrives> torque;
  Eigen::Matrix<double, kMaxCoordinates, 3> moment;
};
inline Linearisation linearise(const Machine& m, const State& s, const Input& in) noexcept {
  Linearisation l{};
  l.acceleration = m.acceleration(s, in);
  l.dq.setZero();
  l.dv.setZero();
  l.dn.setZero();
  l.torque.setZero();
  l.moment.setZero();
  const double h = 1e-6;
  for (int i = 0; i < m.coordinates(); ++i) {
    State a = s, b = s;
    a.q[i] += h;
    b.q[i] -= h;
    l.dq.col(i) = (m.acceleration(a, in) - m.acceleration(b, in)) / (2 * h);
    a = s;
    b = s;
    a.v[i] += h;
    b.v[i] -= h;
    l.dv.col(i) = (m.acceleration(a, in) - m.acceleration(b, in)) / (2 * h);
  }
  for (std::size_t i = 0; i < m.drives.size(); ++i) {
    Input a = in;
    a.drive[i] += 1.0;
    l.torque.col(static_cast<int>(i)) = m.acceleration(s, a) - l.acceleration;
  }
  return l;
}
}  // namespace gyrotwin::model
