#include "services/runtime/machine_reader.hpp"

#include <cstdio>

namespace gyrotwin {

namespace {

enum class MachineKind { kUmbrella, kGimballed, kGyroscope };

constexpr std::array<Word<MachineKind>, 3> kMachineWords{{{"umbrella", MachineKind::kUmbrella},
                                                          {"gimballed", MachineKind::kGimballed},
                                                          {"gyroscope", MachineKind::kGyroscope}}};

constexpr std::array<Word<model::Arrangement>, 3> kArrangementWords{
    {{"single", model::Arrangement::kSingle},
     {"pair", model::Arrangement::kPair},
     {"two_pairs", model::Arrangement::kTwoPairs}}};

constexpr double kSteepest = 1.5;  // [rad], short of a quarter turn

void read_structure(TomlReader& reader, model::UmbrellaParameters::Structure& structure) {
  auto table = reader.table("structure", Need::kRequired);
  table.number("mass_kg", structure.mass, kPositive);
  table.number("cm_height_m", structure.cm_height, kAnyNumber);
  table.number("inertia_x_kgm2", structure.inertia_x, kPositive);
  table.number("inertia_y_kgm2", structure.inertia_y, kPositive);
  table.number("inertia_z_kgm2", structure.inertia_z, kNotNegative);
  table.number("damping_nms_per_rad", structure.damping, kNotNegative);

  const double least = structure.mass * structure.cm_height * structure.cm_height;
  for (const auto& [key, inertia] : {std::pair{"structure.inertia_x_kgm2", structure.inertia_x},
                                     std::pair{"structure.inertia_y_kgm2", structure.inertia_y}}) {
    // A point mass has just the least: leave it its rounding.
    if (inertia < least * (1.0 - 1e-12)) {
      reader.mistake({key, "structure.mass_kg", "structure.cm_height_m"},
                     '`' + std::string(key) + "` is about the ground pivot: expected at least " +
                         "mass_kg * cm_height_m^2 = " + rounded(least) + ", found " +
                         rounded(inertia));
    }
  }
}

/// What both kinds of machine ask of their gyros.
template <class Gyros>
void read_gyro_unit(TomlReader& reader, TomlReader::Table& table, Gyros& gyros) {
  table.number("mass_kg", gyros.mass, kPositive);
  table.number("inertia_transverse_kgm2", gyros.inertia_transverse, kPositive);
  table.number("inertia_axial_kgm2", gyros.inertia_axial, kPositive);
  table.number("rotor_inertia_kgm2", gyros.rotor_inertia, kPositive);
  table.number("rotor_speed_rad_s", gyros.rotor_speed, kAnyNumber);
  table.number("stop_stiffness_nm_per_rad", gyros.stop_stiffness, kPositive);
  table.number("damping_nms_per_rad", gyros.damping, kNotNegative);
  if (gyros.rotor_inertia > gyros.inertia_axial) {
    reader.mistake({"gyros.rotor_inertia_kgm2", "gyros.inertia_axial_kgm2"},
                   "the flywheel's `gyros.rotor_inertia_kgm2` is part of "
                   "`gyros.inertia_axial_kgm2` and cannot be larger");
  }
}

void read_gyros(TomlReader& reader, model::UmbrellaParameters::Gyros& gyros) {
  auto table = reader.table("gyros", Need::kRequired);
  table.integer("count", gyros.count, {3, model::kMaxGyros});
  read_gyro_unit(reader, table, gyros);
  table.number("pivot_radius_m", gyros.pivot_radius, kNotNegative);
  table.number("pivot_height_m", gyros.pivot_height, kAnyNumber);
  table.number("axle_length_m", gyros.axle_length, kPositive);
  table.number("cm_distance_m", gyros.cm_distance, kAnyNumber);
  table.number("ring_elevation_rad", gyros.ring_elevation, {-kSteepest, kSteepest});
  table.number("stop_lower_rad", gyros.stop_lower, {-kSteepest, kSteepest});
  table.number("stop_upper_rad", gyros.stop_upper, {-kSteepest, kSteepest});
  if (gyros.stop_lower >= gyros.stop_upper) {
    reader.mistake({"gyros.stop_lower_rad", "gyros.stop_upper_rad"},
                   "`gyros.stop_lower_rad` must be below `gyros.stop_upper_rad`");
  }
}

model::UmbrellaParameters read_umbrella(TomlReader& reader) {
  model::UmbrellaParameters p{};
  auto umbrella = reader.table("umbrella", Need::kRequired);
  umbrella.word("mount", p.mount, kMountWords);
  umbrella.word("track", p.track, kTrackWords);
  read_structure(reader, p.structure);

  auto disc = reader.table("disc", Need::kRequired);
  disc.number("joint_height_m", p.disc.joint_height, kPositive);
  disc.number("mass_kg", p.disc.mass, kPositive);
  disc.number("cm_offset_m", p.disc.cm_offset, kAnyNumber);
  disc.number("inertia_planar_kgm2", p.disc.inertia_planar, kPositive);
  disc.number("inertia_polar_kgm2", p.disc.inertia_polar, kPositive);
  disc.number("viscous_friction_nms_per_rad", p.disc.viscous_friction, kNotNegative);
  disc.number("coulomb_friction_nm", p.disc.coulomb_friction, kNotNegative);

  read_gyros(reader, p.gyros);

  auto contact = reader.table("contact", Need::kRequired);
  contact.number("stiffness_n_per_m1_5", p.contact.stiffness, kPositive);
  contact.number("damping_s_per_m", p.contact.damping, kNotNegative);
  contact.number("rolling_drag", p.contact.rolling_drag, kNotNegative);
  contact.number("slot_clearance_m", p.contact.slot_clearance, kNotNegative);

  auto bushing = reader.table("bushing", Need::kOptional);
  bushing.number("stiffness_nm_per_rad", p.bushing.stiffness, kNotNegative);
  bushing.number("rotating_damping_nms_per_rad", p.bushing.rotating_damping, kNotNegative);
  bushing.number("standing_damping_nms_per_rad", p.bushing.standing_damping, kNotNegative);

  auto drive = reader.table("drive", Need::kRequired);
  drive.number("motor_inertia_kgm2", p.drive.motor_inertia, kNotNegative);
  drive.number("torque_constant_nm_per_a", p.drive.motor.torque_constant, kPositive);
  drive.number("gear_ratio", p.drive.motor.gear_ratio, kPositive);
  drive.number("resistance_ohm", p.drive.motor.resistance, kPositive);
  drive.number("supply_voltage_v", p.drive.motor.supply_voltage, kPositive);
  drive.number("torque_limit_nm", p.drive.torque_limit, kPositive);
  return p;
}

int gyros_of(model::Arrangement arrangement) {
  switch (arrangement) {
    case model::Arrangement::kSingle:
      return 1;
    case model::Arrangement::kPair:
      return 2;
    case model::Arrangement::kTwoPairs:
      break;
  }
  return 4;
}

model::GimballedParameters read_gimballed(TomlReader& reader) {
  model::GimballedParameters p{};
  reader.table("gimballed", Need::kRequired).word("arrangement", p.arrangement, kArrangementWords);

  auto structure = reader.table("structure", Need::kRequired);
  structure.number("mass_kg", p.structure.mass, kPositive);
  structure.number("cm_height_m", p.structure.cm_height, kAnyNumber);
  structure.number("inertia_tilt_kgm2", p.structure.inertia_tilt, kPositive);
  structure.number("inertia_yaw_ratio", p.structure.inertia_yaw_ratio, kPositive);
  structure.number("damping_nms_per_rad", p.structure.damping, kNotNegative);

  auto gyros = reader.table("gyros", Need::kRequired);
  read_gyro_unit(reader, gyros, p.gyros);
  gyros.number("stop_rad", p.gyros.stop, {0, kSteepest, true});

  reader.table("drive", Need::kRequired).number("torque_limit_nm", p.torque_limit, kPositive);

  const int count = gyros_of(p.arrangement);
  if (count * p.gyros.mass >= p.structure.mass) {
    reader.mistake({"structure.mass_kg", "gyros.mass_kg", "gimballed.arrangement"},
                   "`structure.mass_kg` counts everything and must exceed the " +
                       std::to_string(count) + " gyro units' " + rounded(count * p.gyros.mass) +
                       " kg");
  }
  const double least = p.structure.mass * p.structure.cm_height * p.structure.cm_height;
  if (p.structure.inertia_tilt <= least) {
    reader.mistake({"structure.inertia_tilt_kgm2", "structure.mass_kg", "structure.cm_height_m"},
                   "`structure.inertia_tilt_kgm2` is about the support: it must exceed mass_kg * "
                   "cm_height_m^2 = " +
                       rounded(least) + ", or nothing is left for the chassis without its gyros");
  }
  return p;
}

model::GyroscopeParameters read_gyroscope(TomlReader& reader) {
  model::GyroscopeParameters p{};
  auto gyro = reader.table("gyroscope", Need::kRequired);
  gyro.number("mass_kg", p.gyro.mass, kPositive);
  gyro.number("inertia_transverse_kgm2", p.gyro.inertia_transverse, kPositive);
  gyro.number("inertia_axial_kgm2", p.gyro.inertia_axial, kPositive);
  gyro.number("rotor_inertia_kgm2", p.gyro.rotor_inertia, kPositive);
  gyro.number("rotor_speed_rad_s", p.gyro.rotor_speed, kAnyNumber);
  gyro.number("cm_distance_m", p.gyro.cm_distance, kAnyNumber);
  gyro.number("axle_length_m", p.gyro.axle_length, kPositive);
  gyro.number("stop_rad", p.gyro.stop, {0, kSteepest, true});
  gyro.number("stop_stiffness_nm_per_rad", p.gyro.stop_stiffness, kPositive);
  gyro.number("hinge_damping_nms_per_rad", p.gyro.hinge_damping, kNotNegative);
  gyro.number("post_damping_nms_per_rad", p.gyro.post_damping, kNotNegative);
  gyro.number("post_inertia_kgm2", p.gyro.post_inertia, kNotNegative);
  if (p.gyro.rotor_inertia > p.gyro.inertia_axial) {
    reader.mistake({"gyroscope.rotor_inertia_kgm2", "gyroscope.inertia_axial_kgm2"},
                   "the flywheel's `gyroscope.rotor_inertia_kgm2` is part of "
                   "`gyroscope.inertia_axial_kgm2` and cannot be larger");
  }
  reader.table("drive", Need::kRequired).number("torque_limit_nm", p.torque_limit, kPositive);
  return p;
}

CoordinateNames names_of(const model::UmbrellaParameters& p) {
  if (p.mount == model::Mount::kUniversalJoint) return {"thx", "thy", "bx", "by", "phi", "tg"};
  return {"thx", "thy", "phi", "tg"};
}

CoordinateNames names_of(const model::GimballedParameters& p) {
  if (p.arrangement == model::Arrangement::kTwoPairs) return {"thx", "thy", "qA", "qB"};
  return {"th", "q"};
}

CoordinateNames names_of(const model::GyroscopeParameters&) { return {"psi", "tg"}; }

}  // namespace

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

MachineParameters read_machine(TomlReader& reader, TomlReader::Table& identity) {
  // Without a sound rig.machine, take the kind that the file has a table for.
  auto kind = reader.has_table("gimballed")   ? MachineKind::kGimballed
              : reader.has_table("gyroscope") ? MachineKind::kGyroscope
                                              : MachineKind::kUmbrella;
  identity.word("machine", kind, kMachineWords);
  switch (kind) {
    case MachineKind::kGimballed:
      return read_gimballed(reader);
    case MachineKind::kGyroscope:
      return read_gyroscope(reader);
    case MachineKind::kUmbrella:
      break;
  }
  return read_umbrella(reader);
}

CoordinateNames coordinate_names(const MachineParameters& machine) {
  return std::visit([](const auto& parameters) { return names_of(parameters); }, machine);
}

std::string machine_key(const MachineParameters& machine) {
  constexpr std::array kKeys{"umbrella.mount", "gimballed.arrangement", "rig.machine"};
  return kKeys[machine.index()];
}

}  // namespace gyrotwin
