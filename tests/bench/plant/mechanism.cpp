#include "tests/bench/plant/mechanism.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <variant>

#include "services/runtime/error.hpp"
#include "tests/support/umbrella_track.hpp"

namespace gyrotwin::bench {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::Coordinates;

namespace {

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

// ---- Umbrella ----------------------------------------------------------------------------------

Link umbrella_structure(const model::UmbrellaParameters::Structure& s) {
  const double steiner = s.mass * s.cm_height * s.cm_height;
  return {.parent = -1,
          .position = Vector3d::Zero(),
          .orientation = Matrix3d::Identity(),
          .hinges = {{kX, 0}, {kY, 1}},
          .mass = s.mass,
          .cm = s.cm_height * kZ,
          .inertia = {s.inertia_x - steiner, s.inertia_y - steiner, s.inertia_z}};
}

/// What stays level undoes the structure's turns, last one first.
std::vector<Hinge> disc_hinges(model::Mount mount) {
  switch (mount) {
    case model::Mount::kLevel:
      return {{kY, 1, -1.0}, {kX, 0, -1.0}, {kZ, 2}};
    case model::Mount::kUniversalJoint:
      return {{kX, 2}, {kY, 3}, {kZ, 4}};
    case model::Mount::kRigid:
      break;
  }
  return {{kZ, 2}};
}

Link umbrella_disc(const model::UmbrellaParameters& p) {
  const double G = p.drive.motor.gear_ratio;
  const double polar = p.disc.inertia_polar + p.drive.motor_inertia * G * G;
  return {.parent = 0,
          .position = p.disc.joint_height * kZ,
          .orientation = Matrix3d::Identity(),
          .hinges = disc_hinges(p.mount),
          .mass = p.disc.mass,
          .cm = p.disc.cm_offset * kZ,
          .inertia = {p.disc.inertia_planar, p.disc.inertia_planar, polar}};
}

/// x outward along the axle; a turn about -y raises the outer end.
Link umbrella_gyro(const model::UmbrellaParameters::Gyros& g, int j, int elevation) {
  const double azimuth = 2.0 * std::numbers::pi * j / g.count;
  const Matrix3d orientation = Eigen::AngleAxisd(azimuth, kZ).toRotationMatrix();
  return {.parent = 1,
          .position = orientation * (g.pivot_radius * kX) + g.pivot_height * kZ,
          .orientation = orientation,
          .hinges = {{-kY, elevation}},
          .mass = g.mass,
          .cm = g.cm_distance * kX,
          .inertia = {g.inertia_axial, g.inertia_transverse, g.inertia_transverse},
          .rotor = g.rotor_inertia * kX,
          .rotor_index = j};
}

Mechanism umbrella(const model::UmbrellaParameters& p) {
  const model::TiltBushing& b = p.bushing;
  if (b.stiffness != 0.0 || b.rotating_damping != 0.0 || b.standing_damping != 0.0) {
    throw Error("the engines are not given a bushing between disc and structure");
  }
  Mechanism m;
  m.has_disc = true;
  m.free_disc = p.mount == model::Mount::kUniversalJoint;
  m.coordinates = m.free_disc ? 6 : 4;
  const int elevation = m.coordinates - 1;
  m.links = {umbrella_structure(p.structure), umbrella_disc(p)};
  for (int j = 0; j < p.gyros.count; ++j) m.links.push_back(umbrella_gyro(p.gyros, j, elevation));
  m.damping[0] = m.damping[1] = p.structure.damping;
  m.damping[elevation] = p.gyros.damping;
  m.stops = {{elevation, p.gyros.stop_lower, p.gyros.stop_upper, p.gyros.stop_stiffness}};
  m.friction = {p.disc.viscous_friction, p.disc.coulomb_friction};
  if (p.track != model::TrackKind::kNone) m.track = umbrella_track(p);
  return m;
}

// ---- Gimballed ---------------------------------------------------------------------------------

/// `axial` about one axis, `across` about the two others.
Vector3d moments(const Vector3d& axis, double axial, double across) {
  return Vector3d::Constant(across) + (axial - across) * axis;
}

Mechanism gimballed(const model::GimballedParameters& p) {
  const bool single = p.arrangement == model::Arrangement::kSingle;
  const bool two_axes = p.arrangement == model::Arrangement::kTwoPairs;
  const int gyros = single ? 1 : two_axes ? 4 : 2;
  const int tilts = two_axes ? 2 : 1;
  const auto& s = p.structure;
  const double central = s.inertia_tilt - s.mass * s.cm_height * s.cm_height;

  Mechanism m;
  m.coordinates = tilts + (gyros == 4 ? 2 : 1);
  Link chassis{.parent = -1,
               .position = Vector3d::Zero(),
               .orientation = Matrix3d::Identity(),
               .hinges = {{kX, 0}},
               .mass = s.mass - gyros * p.gyros.mass,
               .cm = s.cm_height * kZ,
               .inertia = {central, central, s.inertia_yaw_ratio * central}};
  if (two_axes) chassis.hinges.push_back({kY, 1});
  m.links = {chassis};
  for (int j = 0; j < gyros; ++j) {
    const double sense = j % 2 == 0 ? 1.0 : -1.0;
    const Vector3d spin = single ? kZ : j < 2 ? kY : kX;
    m.links.push_back({.parent = 0,
                       .position = s.cm_height * kZ,
                       .orientation = Matrix3d::Identity(),
                       .hinges = {{single ? kY : kZ, tilts + j / 2, sense}},
                       .mass = p.gyros.mass,
                       .cm = Vector3d::Zero(),
                       .inertia = moments(spin, p.gyros.inertia_axial, p.gyros.inertia_transverse),
                       .rotor = sense * p.gyros.rotor_inertia * spin,
                       .rotor_index = j});
  }
  for (int i = 0; i < m.coordinates; ++i) {
    m.damping[i] = i < tilts ? s.damping : p.gyros.damping;
    if (i < tilts) continue;
    m.stops.push_back({i, -p.gyros.stop, p.gyros.stop, p.gyros.stop_stiffness});
    m.drives.push_back(i);
  }
  return m;
}

// ---- A disc's tilt, against the world and against the structure --------------------------------

/// A frame that turns, and what its hinges add.
struct Turning {
  Matrix3d R = Matrix3d::Identity();
  Vector3d omega = Vector3d::Zero(), alpha = Vector3d::Zero();

  /// @return the axis, in space
  Vector3d turn(const Vector3d& axis, double angle, double rate, double acceleration) {
    const Vector3d e = R * axis;
    alpha += omega.cross(rate * e) + acceleration * e;
    omega += rate * e;
    R *= Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    return e;
  }
  /// About x, y, z in this order. @return the axes as columns
  Matrix3d turn(const Vector3d& angle, const Vector3d& rate, const Vector3d& acceleration) {
    Matrix3d axes;
    for (int i = 0; i < 3; ++i) {
      axes.col(i) = turn(Vector3d::Unit(i), angle[i], rate[i], acceleration[i]);
    }
    return axes;
  }
};

Turning structure_at(const model::State& state, double thx_acceleration, double thy_acceleration) {
  Turning structure;
  structure.turn(kX, state.q[0], state.v[0], thx_acceleration);
  structure.turn(kY, state.q[1], state.v[1], thy_acceleration);
  return structure;
}

}  // namespace

int Mechanism::hinges() const {
  int count = 0;
  for (const Link& link : links) count += static_cast<int>(link.hinges.size());
  return count;
}

Mechanism mechanism_of(const Rig& rig) {
  if (rig.load_cell) throw Error(rig.name + ": the engines are not given a load cell");
  if (const auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine)) return umbrella(*p);
  if (const auto* p = std::get_if<model::GimballedParameters>(&rig.machine)) return gimballed(*p);
  throw Error(rig.name + ": the engines are given umbrellas and gimballed machines only");
}

Own to_own(const Mechanism& mechanism, const model::State& state) {
  Own own{state.q, state.v};
  if (!mechanism.free_disc) return own;
  const Turning structure = structure_at(state, 0.0, 0.0);
  Turning disc;
  disc.turn(state.q.segment<3>(2), state.v.segment<3>(2), Vector3d::Zero());

  // R = Rx Ry Rz of the three angles, the middle one within a quarter turn.
  const Matrix3d R = structure.R.transpose() * disc.R;
  const Vector3d angle(std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)),
                       std::atan2(-R(0, 1), R(0, 0)));
  const Matrix3d axes = Turning{}.turn(angle, Vector3d::Zero(), Vector3d::Zero());
  own.c.segment<3>(2) = angle;
  own.rate.segment<3>(2) =
      axes.inverse() * (structure.R.transpose() * (disc.omega - structure.omega));
  return own;
}

Coordinates from_own(const Mechanism& mechanism, const model::State& state,
                     const Coordinates& acceleration) {
  Coordinates found = acceleration;
  if (!mechanism.free_disc) return found;
  const Own own = to_own(mechanism, state);
  Turning through_structure = structure_at(state, acceleration[0], acceleration[1]);
  through_structure.turn(own.c.segment<3>(2), own.rate.segment<3>(2), acceleration.segment<3>(2));
  Turning absolute;
  const Matrix3d axes =
      absolute.turn(state.q.segment<3>(2), state.v.segment<3>(2), Vector3d::Zero());
  found.segment<3>(2) = axes.inverse() * (through_structure.alpha - absolute.alpha);
  return found;
}

Reduction::Reduction(const Mechanism& mechanism) : coordinates_(mechanism.coordinates) {
  for (const Link& link : mechanism.links) {
    for (const Hinge& hinge : link.hinges) {
      coordinate_.push_back(hinge.coordinate);
      coefficient_.push_back(hinge.coefficient);
    }
  }
  clear();
}

Coordinates Reduction::solve() const {
  using Capacity = model::Coordinates;
  constexpr int kMax = Capacity::RowsAtCompileTime;
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMax, kMax> M =
      M_.topLeftCorner(coordinates_, coordinates_);
  Coordinates x = Coordinates::Zero();
  x.head(coordinates_) = M.llt().solve(f_.head(coordinates_));
  return x;
}

}  // namespace gyrotwin::bench
