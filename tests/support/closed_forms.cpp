#include "tests/support/closed_forms.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace gyrotwin::reference {

using Eigen::Vector3d;
using model::Coordinates;

namespace {

constexpr double g = model::kGravity;

/// Inertias of disc and gyros together, about axes through the disc's joint that tilt with it.
struct Assembly {
  double ma;      ///< moving mass [kg]
  double Jz, Jp;  ///< polar, planar [kg m^2]
  double Jg;      ///< of the elevation [kg m^2]
  double Jz_tg;   ///< dJz/dtg [kg m^2/rad]
  double S1;      ///< first moment along z_D [kg m]
  double Nh;      ///< sum of the rotors' momenta [N m s]
};

Assembly assembly(const model::UmbrellaParameters& p, double tg) {
  const auto& y = p.gyros;
  const double N = y.count, It = y.inertia_transverse, Ix = y.inertia_axial, d = y.cm_distance;
  const double c = std::cos(tg), s = std::sin(tg);
  const double rho = y.pivot_radius + d * c, zc = y.pivot_height + d * s;
  const double G = p.drive.motor.gear_ratio;
  const double mD = p.disc.mass, eD = p.disc.cm_offset;
  Assembly a;
  a.ma = mD + N * y.mass;
  a.Jz = p.disc.inertia_polar + p.drive.motor_inertia * G * G +
         N * (y.mass * rho * rho + It * c * c + Ix * s * s);
  a.Jp = p.disc.inertia_planar + mD * eD * eD +
         N * (y.mass * (rho * rho / 2 + zc * zc) + (It * (1 + s * s) + Ix * c * c) / 2);
  a.Jg = N * (It + y.mass * d * d);
  a.Jz_tg = N * (-2 * y.mass * rho * d * s + 2 * (Ix - It) * s * c);
  a.S1 = mD * eD + N * y.mass * zc;
  a.Nh = N * y.rotor_inertia * y.rotor_speed;
  return a;
}

}  // namespace

double stop_torque(double lower, double upper, double stiffness, double q, double v) {
  const double d = std::max(q - upper, 0.0) + std::min(q - lower, 0.0);
  const bool deeper = d * v > 0.0;
  return -stiffness * d - (deeper ? 0.02 * stiffness * v * std::min(1.0, std::abs(d) / 0.01) : 0.0);
}

Coordinates level_acceleration(const model::UmbrellaParameters& p, const model::State& state,
                               double tau) {
  const auto& y = p.gyros;
  const double tg = state.q[3];
  const Assembly m = assembly(p, tg);
  const double sx = std::sin(state.q[0]), cx = std::cos(state.q[0]);
  const double sy = std::sin(state.q[1]), cy = std::cos(state.q[1]);
  const double s = std::sin(tg), c = std::cos(tg);
  const double wx = state.v[0], wy = state.v[1], phi_t = state.v[2], tg_t = state.v[3];
  const double hd = p.disc.joint_height;
  const double a = p.structure.inertia_x + m.ma * hd * hd;
  const double b = p.structure.inertia_y + m.ma * hd * hd;
  const double Iz = p.structure.inertia_z;
  const double B = y.count * y.mass * y.cm_distance * hd;
  const double e = a - Iz;
  const double U = g * (p.structure.mass * p.structure.cm_height + m.ma * hd);

  Eigen::Matrix4d M;
  M << a * cy * cy + Iz * sy * sy, 0, 0, -B * c * sx * cy,  //
      0, b, 0, -B * c * cx * sy,                            //
      0, 0, m.Jz, 0,                                        //
      -B * c * sx * cy, -B * c * cx * sy, 0, m.Jg;
  Eigen::Vector4d f;
  f << 2 * e * sy * cy * wx * wy - B * sx * cy * s * tg_t * tg_t + U * sx * cy,
      -e * sy * cy * wx * wx - B * cx * sy * s * tg_t * tg_t + U * cx * sy,
      -m.Jz_tg * tg_t * phi_t - m.Nh * c * tg_t,
      m.Jz_tg / 2 * phi_t * phi_t + m.Nh * c * phi_t +
          B * c * (cx * cy * (wx * wx + wy * wy) - 2 * sx * sy * wx * wy) -
          y.count * y.mass * g * y.cm_distance * c;

  // The disc turns about the vertical, the structure's spin about it is -wy sin(thx).
  const double spin = phi_t - wy * sx;
  const double torque =
      tau - p.disc.viscous_friction * spin - p.disc.coulomb_friction * std::tanh(spin / 0.05);
  f += Eigen::Vector4d(
      -p.structure.damping * wx, -p.structure.damping * wy - torque * sx, torque,
      -y.damping * tg_t + stop_torque(y.stop_lower, y.stop_upper, y.stop_stiffness, tg, tg_t));
  Coordinates result = Coordinates::Zero();
  result.head<4>() = M.ldlt().solve(f);
  return result;
}

UmbrellaEnergy umbrella_energy(const model::UmbrellaParameters& p, const model::Observation& o) {
  const auto& y = p.gyros;
  const double tg = o.gimbal_angle[0], tg_t = o.gimbal_rate[0];
  const Assembly m = assembly(p, tg);
  const double hd = p.disc.joint_height;

  // Structure: rates in its own axes, its axis z_S and how that moves.
  const double sx = std::sin(o.tilt[0]), cx = std::cos(o.tilt[0]);
  const double sy = std::sin(o.tilt[1]), cy = std::cos(o.tilt[1]);
  const double x_t = o.tilt_rate[0], y_t = o.tilt_rate[1];
  const Vector3d w_S(x_t * cy, y_t, x_t * sy);
  const Vector3d z_S(sy, -sx * cy, cx * cy);
  const Vector3d z_S_t(cy * y_t, -cx * cy * x_t + sx * sy * y_t, -sx * cy * x_t - cx * sy * y_t);

  // Disc: rates in axes that tilt, but do not spin, with it; and the world's axes seen from there.
  const double bsx = std::sin(o.disc_tilt[0]), bcx = std::cos(o.disc_tilt[0]);
  const double bsy = std::sin(o.disc_tilt[1]), bcy = std::cos(o.disc_tilt[1]);
  const Vector3d w(o.disc_tilt_rate[0] * bcy, o.disc_tilt_rate[1],
                   o.disc_tilt_rate[0] * bsy + o.disc_rate);
  Eigen::Matrix3d R_D;
  R_D << bcy, 0, bsy, bsx * bsy, bcx, -bsx * bcy, -bcx * bsy, bsx, bcx * bcy;
  const Vector3d v = R_D.transpose() * (hd * z_S_t);

  UmbrellaEnergy energy;
  energy.T2 =
      0.5 * (p.structure.inertia_x * w_S.x() * w_S.x() + p.structure.inertia_y * w_S.y() * w_S.y() +
             p.structure.inertia_z * w_S.z() * w_S.z()) +
      0.5 * m.Jp * (w.x() * w.x() + w.y() * w.y()) + 0.5 * m.Jz * w.z() * w.z() +
      0.5 * m.Jg * tg_t * tg_t + 0.5 * m.ma * v.squaredNorm() +
      m.S1 * v.dot(w.cross(Vector3d::UnitZ())) +
      y.count * y.mass * y.cm_distance * std::cos(tg) * tg_t * v.z();
  energy.T1 = m.Nh * std::sin(tg) * w.z();
  energy.V = g * (p.structure.mass * p.structure.cm_height * z_S.z() + m.ma * hd * z_S.z() +
                  m.S1 * bcx * bcy);
  return energy;
}

Coordinates pair_acceleration(const model::GimballedParameters& p, const model::State& state,
                              double u, double moment) {
  const double th_t = state.v[0], q_t = state.v[1];
  const double s = std::sin(state.q[1]), c = std::cos(state.q[1]);
  const double It = p.gyros.inertia_transverse, Ix = p.gyros.inertia_axial;
  const double A = p.structure.inertia_tilt + 2 * (It * c * c + Ix * s * s);
  const double dA = 4 * (Ix - It) * s * c;
  const double H = 2 * p.gyros.rotor_inertia * p.gyros.rotor_speed;
  const double U = p.structure.mass * g * p.structure.cm_height;
  Coordinates a = Coordinates::Zero();
  a[0] = (-dA * q_t * th_t + H * c * q_t + U * std::sin(state.q[0]) - p.structure.damping * th_t +
          moment) /
         A;
  a[1] = (dA / 2 * th_t * th_t - H * c * th_t - p.gyros.damping * q_t + u +
          stop_torque(-p.gyros.stop, p.gyros.stop, p.gyros.stop_stiffness, state.q[1], q_t)) /
         (2 * It);
  return a;
}

Coordinates single_acceleration(const model::GimballedParameters& p, const model::State& state,
                                double u, double moment) {
  const double th_t = state.v[0], q_t = state.v[1];
  const double s = std::sin(state.q[1]), c = std::cos(state.q[1]);
  const double It = p.gyros.inertia_transverse, Ix = p.gyros.inertia_axial;
  const double A = p.structure.inertia_tilt + It * c * c + Ix * s * s;
  const double dA = 2 * (Ix - It) * s * c;
  const double h = p.gyros.rotor_inertia * p.gyros.rotor_speed;
  const double U = p.structure.mass * g * p.structure.cm_height;
  Coordinates a = Coordinates::Zero();
  a[0] = (-dA * q_t * th_t - h * c * q_t + U * std::sin(state.q[0]) - p.structure.damping * th_t +
          moment) /
         A;
  a[1] = (dA / 2 * th_t * th_t + h * c * th_t - p.gyros.damping * q_t + u +
          stop_torque(-p.gyros.stop, p.gyros.stop, p.gyros.stop_stiffness, state.q[1], q_t)) /
         It;
  return a;
}

Coordinates two_pairs_acceleration(const model::GimballedParameters& p, const model::State& state,
                                   double uA, double uB) {
  const auto& y = p.gyros;
  const double It = y.inertia_transverse, Ix = y.inertia_axial, h = y.rotor_inertia * y.rotor_speed;
  const double sx = std::sin(state.q[0]), cx = std::cos(state.q[0]);
  const double sy = std::sin(state.q[1]), cy = std::cos(state.q[1]);
  const double sa = std::sin(state.q[2]), ca = std::cos(state.q[2]);
  const double sb = std::sin(state.q[3]), cb = std::cos(state.q[3]);
  const double x_t = state.v[0], y_t = state.v[1], a_t = state.v[2], b_t = state.v[3];
  const double A0 = p.structure.inertia_tilt;
  const double zc = p.structure.cm_height;
  const double Icz = p.structure.inertia_yaw_ratio * (A0 - p.structure.mass * zc * zc);
  const double I1 = A0 + 2 * (It * ca * ca + Ix * sa * sa) + 2 * (Ix * cb * cb + It * sb * sb);
  const double I2 = A0 + 2 * (Ix * ca * ca + It * sa * sa) + 2 * (It * cb * cb + Ix * sb * sb);
  const double I3 = Icz + 4 * It;
  const double d1a = 4 * (Ix - It) * sa * ca, d1b = -4 * (Ix - It) * sb * cb;
  const double I1_t = d1a * a_t + d1b * b_t, I2_t = -I1_t;
  const double w1 = x_t * cy, w2 = y_t;
  const double hx = -2 * h * sa;
  const double U = p.structure.mass * g * zc;
  const auto stop = [&y](double q, double v) {
    return stop_torque(-y.stop, y.stop, y.stop_stiffness, q, v) - y.damping * v;
  };
  const double cth = p.structure.damping;
  Coordinates a = Coordinates::Zero();
  a[0] = (-(I1_t * cy * cy * x_t + 2 * (I3 - I1) * sy * cy * y_t * x_t) + 2 * h * ca * cy * a_t +
          hx * sy * y_t + U * sx * cy - cth * x_t) /
         (I1 * cy * cy + I3 * sy * sy);
  a[1] = (-I2_t * y_t - 2 * h * cb * b_t + (I3 - I1) * sy * cy * x_t * x_t - hx * sy * x_t +
          U * cx * sy - cth * y_t) /
         I2;
  a[2] = (0.5 * (d1a * w1 * w1 - d1a * w2 * w2) - 2 * h * ca * w1 + uA + stop(state.q[2], a_t)) /
         (2 * It);
  a[3] = (0.5 * (d1b * w1 * w1 - d1b * w2 * w2) + 2 * h * cb * w2 + uB + stop(state.q[3], b_t)) /
         (2 * It);
  return a;
}

Coordinates gyroscope_acceleration(const model::GyroscopeParameters& p, const model::State& state,
                                   double tau, double weight) {
  const auto& y = p.gyro;
  const double psi_t = state.v[0], tg_t = state.v[1];
  const double s = std::sin(state.q[1]), c = std::cos(state.q[1]);
  const double J = y.inertia_transverse + y.mass * y.cm_distance * y.cm_distance;
  const double Jpsi = y.post_inertia + J * c * c + y.inertia_axial * s * s;
  const double dJpsi = 2 * (y.inertia_axial - J) * s * c;
  const double h = y.rotor_inertia * y.rotor_speed;
  Coordinates a = Coordinates::Zero();
  a[0] = (-dJpsi * tg_t * psi_t - h * c * tg_t - y.post_damping * psi_t + tau) / Jpsi;
  a[1] = (dJpsi / 2 * psi_t * psi_t + h * c * psi_t - y.mass * g * y.cm_distance * c -
          weight * y.axle_length * c - y.hinge_damping * tg_t +
          stop_torque(-y.stop, y.stop, y.stop_stiffness, state.q[1], tg_t)) /
         J;
  return a;
}

}  // namespace gyrotwin::reference
