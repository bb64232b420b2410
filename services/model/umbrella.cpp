#include "services/model/umbrella.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "services/model/evaluate.hpp"

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

constexpr int kDisc = 1;

Layout layout_of(const UmbrellaParameters& p) {
  Layout layout;
  layout.tilt = {0, 1};
  if (p.mount == Mount::kUniversalJoint) {
    layout.names = {"thx", "thy", "bx", "by", "phi", "tg"};
    layout.disc_tilt = {2, 3};
    layout.disc = 4;
  } else {
    layout.names = {"thx", "thy", "phi", "tg"};
    layout.disc = 2;
  }
  layout.disc_follows_structure = p.mount == Mount::kRigid;
  layout.gimbals.assign(p.gyros.count, {layout.disc + 1, 1.0});
  return layout;
}

Body structure_body(const UmbrellaParameters::Structure& s) {
  Body body;
  body.mass = s.mass;
  body.cm = {0.0, 0.0, s.cm_height};
  const double steiner = s.mass * s.cm_height * s.cm_height;
  body.inertia = {s.inertia_x - steiner, s.inertia_y - steiner, s.inertia_z};
  return body;
}

double polar_inertia(const UmbrellaParameters& p) {
  const double G = p.drive.motor.gear_ratio;
  return p.disc.inertia_polar + p.drive.motor_inertia * G * G;
}

Body disc_body(const UmbrellaParameters& p) {
  Body body;
  body.pivot = {0.0, 0.0, p.disc.joint_height};
  body.mass = p.disc.mass;
  body.cm = {0.0, 0.0, p.disc.cm_offset};
  body.inertia = {p.disc.inertia_planar, p.disc.inertia_planar, polar_inertia(p)};
  return body;
}

/// On the disc: spin axis s_j = cos tg e_r + sin tg e_z.
Gyro gyro_of(const UmbrellaParameters::Gyros& g, int j) {
  const double azimuth = 2.0 * std::numbers::pi * j / g.count;
  const Vector3d e_r(std::cos(azimuth), std::sin(azimuth), 0.0), e_z = Vector3d::UnitZ();
  return {.pivot = g.pivot_radius * e_r + g.pivot_height * e_z,
          .axis = e_r,
          .raised = e_z,
          .mass = g.mass,
          .cm_distance = g.cm_distance,
          .axial_inertia = g.inertia_axial,
          .planar_inertia = g.inertia_transverse,
          .rotor_inertia = g.rotor_inertia,
          .rotor_index = j};
}

Tree build_tree(const UmbrellaParameters& p, Mount mount) {
  const std::vector<Body> bodies{structure_body(p.structure), disc_body(p)};
  std::vector<Gyro> gyros;
  gyros.reserve(p.gyros.count);
  for (int j = 0; j < p.gyros.count; ++j) gyros.push_back(gyro_of(p.gyros, j));
  const std::vector<Gimbal> gimbals{Gimbal(gyros)};
  switch (mount) {
    case Mount::kLevel:
      return make_tree<shape_of(Mount::kLevel)>(bodies, gimbals);
    case Mount::kRigid:
      return make_tree<shape_of(Mount::kRigid)>(bodies, gimbals);
    case Mount::kUniversalJoint:
      break;
  }
  return make_tree<shape_of(Mount::kUniversalJoint)>(bodies, gimbals);
}

}  // namespace

Machine build(const UmbrellaParameters& p) {
  if (p.gyros.count < 3 || p.gyros.count > kMaxGyros) {
    throw std::invalid_argument("umbrella: 3 or 4 gyros");
  }
  const Layout layout = layout_of(p);
  const int elevation = layout.disc + 1;
  Machine machine{build_tree(p, p.mount), layout};
  machine.rotors = p.gyros.count;
  for (int j = 0; j < p.gyros.count; ++j) machine.nominal_rotor_speed[j] = p.gyros.rotor_speed;
  machine.push_point = {0.0, 0.0, p.structure.cm_height};
  machine.damping[0] = machine.damping[1] = p.structure.damping;
  machine.damping[elevation] = p.gyros.damping;
  machine.stops = {{elevation, p.gyros.stop_lower, p.gyros.stop_upper, p.gyros.stop_stiffness}};
  machine.drives = {{Drive::Kind::kDisc, layout.disc, p.drive.motor, p.drive.torque_limit}};
  machine.disc_body = kDisc;
  machine.disc_friction = {p.disc.viscous_friction, p.disc.coulomb_friction};
  machine.bushing = p.bushing;
  if (p.track != TrackKind::kNone) {
    const double height = p.disc.joint_height + p.gyros.pivot_height +
                          p.gyros.axle_length * std::sin(p.gyros.ring_elevation);
    machine.track = {p.gyros.axle_length, height,
                     std::nullopt,        p.contact.stiffness,
                     p.contact.damping,   p.contact.rolling_drag};
    if (p.track == TrackKind::kSlot) machine.track->clearance = p.contact.slot_clearance;
  }
  if (p.mount == Mount::kLevel) machine.unheld = build_tree(p, Mount::kUniversalJoint);
  return machine;
}

ReducedUmbrella reduce(const UmbrellaParameters& p) {
  const auto& g = p.gyros;
  const double s = std::sin(g.ring_elevation);
  const double c = std::cos(g.ring_elevation);
  const double rho = g.pivot_radius + g.cm_distance * c;
  const double moving_mass = p.disc.mass + g.count * g.mass;
  const double hd = p.disc.joint_height;

  ReducedUmbrella r;
  const double reach = g.axle_length * c;
  r.k = (g.pivot_radius + reach) / reach;
  r.Nh = g.count * g.rotor_inertia * g.rotor_speed;
  r.H = r.Nh * c * r.k;
  const double Jg = g.count * (g.inertia_transverse + g.mass * g.cm_distance * g.cm_distance);
  r.A = p.structure.inertia_x + moving_mass * hd * hd + Jg * r.k * r.k;
  r.C = polar_inertia(p) +
        g.count * (g.mass * rho * rho + g.inertia_transverse * c * c + g.inertia_axial * s * s);
  r.U = kGravity * (p.structure.mass * p.structure.cm_height + moving_mass * hd);
  return r;
}

}  // namespace gyrotwin::model
