#include "services/model/gimballed.hpp"

#include "services/model/evaluate.hpp"

namespace gyrotwin::model {

using Eigen::Vector3d;

namespace {

int gyros_of(Arrangement arrangement) {
  return arrangement == Arrangement::kSingle ? 1 : arrangement == Arrangement::kPair ? 2 : 4;
}

/// Its hinge is across `axis` and `raised`, at the height of the chassis' cm.
Gyro gyro_of(const GimballedParameters& p, int index, const Vector3d& axis,
             const Vector3d& raised) {
  const auto& g = p.gyros;
  return {.pivot = {0.0, 0.0, p.structure.cm_height},
          .axis = axis,
          .raised = raised,
          .mass = g.mass,
          .cm_distance = 0.0,
          .axial_inertia = g.inertia_axial,
          .planar_inertia = g.inertia_transverse,
          .rotor_inertia = g.rotor_inertia,
          .rotor_index = index};
}

Tree build_tree(Arrangement arrangement, const Body& chassis, const std::vector<Gimbal>& gimbals) {
  switch (arrangement) {
    case Arrangement::kSingle:
      return make_tree<shape_of(Arrangement::kSingle)>({chassis}, gimbals);
    case Arrangement::kPair:
      return make_tree<shape_of(Arrangement::kPair)>({chassis}, gimbals);
    case Arrangement::kTwoPairs:
      break;
  }
  return make_tree<shape_of(Arrangement::kTwoPairs)>({chassis}, gimbals);
}

}  // namespace

Machine build(const GimballedParameters& p) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const int gyros = gyros_of(p.arrangement);
  const bool two_axes = p.arrangement == Arrangement::kTwoPairs;

  Layout layout;
  Body chassis;
  layout.tilt = {0, kFixed};
  if (two_axes) {
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

  std::vector<Gimbal> gimbals;
  const int first = two_axes ? 2 : 1;
  if (p.arrangement == Arrangement::kSingle) {
    gimbals.emplace_back(std::vector{gyro_of(p, 0, z, x)});
    layout.gimbals = {{first, 1.0}};
  } else {
    // Counter-rotating, geared 1 : -1.
    gimbals.emplace_back(std::vector{gyro_of(p, 0, y, -x), gyro_of(p, 1, -y, -x)});
    layout.gimbals = {{first, 1.0}, {first, -1.0}};
  }
  if (two_axes) {
    gimbals.emplace_back(std::vector{gyro_of(p, 2, x, y), gyro_of(p, 3, -x, y)});
    layout.gimbals.insert(layout.gimbals.end(), {{first + 1, 1.0}, {first + 1, -1.0}});
  }

  const int drives = gyros == 4 ? 2 : 1;
  Machine machine{build_tree(p.arrangement, chassis, gimbals), layout};
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
