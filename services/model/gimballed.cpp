#include "services/model/gimballed.hpp"

#include <numbers>

namespace gyrotwin::model {

namespace {

constexpr int kChassis = 0;

int gyros_of(Arrangement arrangement) {
  return arrangement == Arrangement::kSingle ? 1 : arrangement == Arrangement::kPair ? 2 : 4;
}

/// Body x axis: the spin axis at speed > 0; `alignment` turns the chassis' x axis there at q = 0.
Body gyro_body(const GimballedParameters& p, int index, const Rotation& gimbal,
               const Rotation& alignment, double direction) {
  Body body;
  body.position_parent = kChassis;
  body.orientation_parent = kChassis;
  body.pivot = {0.0, 0.0, p.structure.cm_height};
  body.rotations = {gimbal, alignment};
  body.mass = p.gyros.mass;
  body.inertia = {p.gyros.inertia_axial, p.gyros.inertia_transverse, p.gyros.inertia_transverse};
  body.rotor = {direction * p.gyros.rotor_inertia, 0.0, 0.0};
  body.rotor_index = index;
  return body;
}

}  // namespace

Machine build(const GimballedParameters& p) {
  constexpr double kQuarterTurn = std::numbers::pi / 2.0;
  const Rotation to_y{Axis::kZ, kFixed, 1.0, kQuarterTurn};
  const Rotation to_x{Axis::kZ, kFixed, 1.0, 0.0};
  const Rotation to_z{Axis::kY, kFixed, 1.0, -kQuarterTurn};
  const int gyros = gyros_of(p.arrangement);
  const bool two_axes = p.arrangement == Arrangement::kTwoPairs;

  Layout layout;
  Body chassis;
  chassis.rotations = {{Axis::kX, 0}};
  layout.tilt = {0, kFixed};
  if (two_axes) {
    chassis.rotations.push_back({Axis::kY, 1});
    layout.tilt = {0, 1};
    layout.names = {"thx", "thy", "qA", "qB"};
  } else {
    layout.names = {"th", "q"};
  }
  const double zc = p.structure.cm_height;
  const double inertia = p.structure.inertia_tilt - p.structure.mass * zc * zc;
  chassis.mass = p.structure.mass - gyros * p.gyros.mass;
  chassis.cm = {0.0, 0.0, zc};
  chassis.inertia = {inertia, inertia, p.structure.inertia_yaw_ratio * inertia};

  std::vector<Body> bodies{chassis};
  const int first = two_axes ? 2 : 1;
  if (p.arrangement == Arrangement::kSingle) {
    bodies.push_back(gyro_body(p, 0, {Axis::kY, first}, to_z, 1.0));
    layout.gimbals = {{first, 1.0}};
  } else {
    for (int j = 0; j < gyros; ++j) {
      const int pair = j / 2;
      const double sense = j % 2 == 0 ? 1.0 : -1.0;  // counter-rotating, geared 1 : -1
      bodies.push_back(
          gyro_body(p, j, {Axis::kZ, first + pair, sense}, pair == 0 ? to_y : to_x, sense));
      layout.gimbals.push_back({first + pair, sense});
    }
  }

  const int drives = gyros == 4 ? 2 : 1;
  Machine machine{Tree(std::move(bodies), first + drives), layout};
  machine.rotors = gyros;
  for (int j = 0; j < gyros; ++j) machine.nominal_rotor_speed[j] = p.gyros.rotor_speed;
  machine.push_point = {0.0, 0.0, zc};
  for (int i = 0; i < first; ++i) machine.damping[i] = p.structure.damping;
  for (int i = 0; i < drives; ++i) {
    const int coordinate = first + i;
    machine.damping[coordinate] = p.gyros.damping;
    machine.stops.push_back({coordinate, -p.gyros.stop, p.gyros.stop, p.gyros.stop_stiffness});
    machine.drives.push_back({Drive::Kind::kGimbal, coordinate, std::nullopt, p.torque_limit});
  }
  return machine;
}

ReducedGimballed reduce(const GimballedParameters& p) {
  const int gyros = gyros_of(p.arrangement);
  const double h = p.gyros.rotor_inertia * p.gyros.rotor_speed;
  ReducedGimballed r;
  // About the roll axis at q = 0: each unit's own inertia comes on top of the inertia with its
  // mass.
  const double It = p.gyros.inertia_transverse;
  const double Ix = p.gyros.inertia_axial;
  r.A = p.structure.inertia_tilt + (gyros == 1 ? It : 2 * It) + (gyros == 4 ? 2 * Ix : 0.0);
  r.J = gyros == 1 ? It : 2 * It;
  r.U = p.structure.mass * kGravity * p.structure.cm_height;
  r.H = gyros == 1 ? h : 2 * h;
  r.cth = p.structure.damping;
  r.cq = p.gyros.damping;
  return r;
}

}  // namespace gyrotwin::model
