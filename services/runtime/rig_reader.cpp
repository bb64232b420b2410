#include "services/runtime/rig_reader.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <variant>

namespace gyrotwin {

namespace {

using Names = std::vector<std::string_view>;

enum class MachineKind { kUmbrella, kGimballed };

constexpr std::array<Word<MachineKind>, 2> kMachineWords{
    {{"umbrella", MachineKind::kUmbrella}, {"gimballed", MachineKind::kGimballed}}};

constexpr std::array<Word<ClockMode>, 3> kClockWords{{{"realtime", ClockMode::kRealtime},
                                                      {"lockstep", ClockMode::kLockstep},
                                                      {"free", ClockMode::kFree}}};

constexpr std::array<Word<OverrunPolicy>, 2> kOverrunWords{
    {{"skip", OverrunPolicy::kSkip}, {"stop", OverrunPolicy::kStop}}};

constexpr std::array<Word<SafeStopDrive>, 3> kSafeStopWords{
    {{"zero_torque", SafeStopDrive::kZeroTorque},
     {"brake", SafeStopDrive::kBrake},
     {"hold_speed", SafeStopDrive::kHoldSpeed}}};

constexpr std::array<Word<model::Arrangement>, 3> kArrangementWords{
    {{"single", model::Arrangement::kSingle},
     {"pair", model::Arrangement::kPair},
     {"two_pairs", model::Arrangement::kTwoPairs}}};

constexpr double kSteepest = 1.5;  // [rad], short of a quarter turn

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

bool made_of(const std::string& text, std::string_view alphabet, std::size_t longest) {
  return !text.empty() && text.size() <= longest &&
         text.find_first_not_of(alphabet) == std::string::npos;
}

constexpr TextRule kName{"a text of a-z 0-9 _, at most 31 characters", [](const std::string& t) {
                           return made_of(t, "abcdefghijklmnopqrstuvwxyz0123456789_", 31);
                         }};

constexpr TextRule kSentence{
    "a text on one line", [](const std::string& t) {
      return std::none_of(t.begin(), t.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; });
    }};

// Leaves room for the longest channel of messages/channels.hpp within 63 characters.
constexpr TextRule kPrefix{"a text of A-Z 0-9 _, at most 31 characters", [](const std::string& t) {
                             return made_of(t, "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", 31);
                           }};

constexpr TextRule kGroup{
    "an IPv4 multicast address, 224.0.0.0 to 239.255.255.255", [](const std::string& t) {
      in_addr address{};
      return inet_pton(AF_INET, t.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
    }};

constexpr TextRule kInterface{
    "a network interface's name, at most 15 characters", [](const std::string& t) {
      return !t.empty() && t.size() <= 15 && std::none_of(t.begin(), t.end(), [](unsigned char c) {
        return c <= ' ' || c == '/' || c >= 0x7f;
      });
    }};

void read_network(TomlReader& reader, Rig::Network& network) {
  auto table = reader.table("network", Need::kRequired);
  table.text("prefix", network.prefix, kPrefix);
  table.text("group", network.group, kGroup);
  table.integer("port", network.port, {1, 65535});
  table.text("interface", network.interface, kInterface);
  const bool ttl = table.integer("ttl", network.ttl, {0, 255});
  const bool sign = table.flag("sign", network.sign);
  if (ttl && sign && !network.sign && network.ttl > 0) {
    reader.mistake({"network.sign", "network.ttl"},
                   "an unsigned rig must stay on this host: set `network.sign = true` or "
                   "`network.ttl = 0`");
  }
}

void read_loop(TomlReader& reader, Rig::Loop& loop) {
  auto table = reader.table("loop", Need::kOptional);
  table.word("clock", loop.clock, kClockWords);
  table.number("rate_hz", loop.rate_hz, {1, 10000});
  table.integer("substeps", loop.substeps, {1, 1000});
  table.number("step_tolerance_rad", loop.step_tolerance, {0, 1, true});
  table.integer("command_delay_ticks", loop.command_delay_ticks, {0, Rig::Loop::kMaxCommandDelay});
  table.word("overrun", loop.overrun, kOverrunWords);
  table.number("patience_s", loop.patience_s, {0, 10});
}

void read_safety(TomlReader& reader, Rig::Safety& safety, bool has_disc_drive) {
  auto table = reader.table("safety", Need::kOptional);
  table.integer("command_timeout_ticks", safety.command_timeout_ticks, {1, 10});
  table.number("fall_tilt_rad", safety.fall_tilt_rad, {0, 1.5, true});
  table.word("safe_stop", safety.drive, kSafeStopWords);
  table.number("safe_stop_gain_nms_per_rad", safety.gain, kNotNegative);
  const bool brakes_a_motor = safety.drive == SafeStopDrive::kBrake && has_disc_drive;
  if (safety.drive != SafeStopDrive::kZeroTorque && !brakes_a_motor && safety.gain == 0.0) {
    reader.mistake({"safety.safe_stop", "safety.safe_stop_gain_nms_per_rad"},
                   "this safe stop needs `safety.safe_stop_gain_nms_per_rad` > 0");
  }
}

void read_controller(TomlReader& reader, Rig::Controller& controller) {
  auto table = reader.table("controller", Need::kOptional);
  table.word("law", controller.law, kLawWords);
  table.number("disc_speed_rad_s", controller.disc_speed, kAnyNumber);
  table.number("kp_nms_per_rad", controller.kp, kNotNegative);
  table.number("ki_nm_per_rad", controller.ki, kNotNegative);
  table.number("integral_limit_nm", controller.integral_limit, kNotNegative);
  table.number("momentum_rate_per_s", controller.momentum_rate, kPositive);
  table.number("elevation_gain_nm_per_rad", controller.elevation_gain, kNotNegative);
  table.numbers("gain", controller.gain);
  table.number("tilt_max_rad", controller.tilt_max, kPositive);
  table.number("speed_max_rad_s", controller.speed_max, kPositive);
  table.number("gimbal_max_rad", controller.gimbal_max, kPositive);
  table.number("torque_max_nm", controller.torque_max, kPositive);
}

/// `initial` q or v: one number per coordinate.
void read_coordinates(TomlReader& reader, TomlReader::Table& table, const char* key,
                      std::vector<double>& values, const Names& names,
                      const std::string& decided_by) {
  if (!table.numbers(key, values) || values.size() == names.size()) return;
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  const std::string path = std::string("initial.") + key;
  reader.mistake({path, decided_by}, '`' + path + "` has " + std::to_string(values.size()) +
                                         " numbers, expected " + std::to_string(names.size()) +
                                         ": (" + list + "), as `" + decided_by + "` says");
}

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

Names coordinate_names(const model::UmbrellaParameters& p) {
  if (p.mount == model::Mount::kUniversalJoint) return {"thx", "thy", "bx", "by", "phi", "tg"};
  return {"thx", "thy", "phi", "tg"};
}

Names coordinate_names(const model::GimballedParameters& p) {
  if (p.arrangement == model::Arrangement::kTwoPairs) return {"thx", "thy", "qA", "qB"};
  return {"th", "q"};
}

}  // namespace

Rig read_rig(TomlReader& reader) {
  Rig rig;
  auto identity = reader.table("rig", Need::kRequired);
  identity.text("name", rig.name, kName);
  identity.text("summary", rig.summary, kSentence);
  identity.integer("id", rig.id, {1, 255});
  // Without a sound rig.machine, take the kind that the file has a table for.
  auto kind = reader.has_table("gimballed") ? MachineKind::kGimballed : MachineKind::kUmbrella;
  identity.word("machine", kind, kMachineWords);
  const bool umbrella = kind == MachineKind::kUmbrella;

  read_network(reader, rig.network);
  read_loop(reader, rig.loop);
  read_safety(reader, rig.safety, umbrella);
  if (umbrella) {
    rig.machine = read_umbrella(reader);
  } else {
    rig.machine = read_gimballed(reader);
  }
  read_controller(reader, rig.controller);

  const Names names =
      std::visit([](const auto& parameters) { return coordinate_names(parameters); }, rig.machine);
  const char* decided_by = umbrella ? "umbrella.mount" : "gimballed.arrangement";
  auto initial = reader.table("initial", Need::kRequired);
  read_coordinates(reader, initial, "q", rig.initial_q, names, decided_by);
  read_coordinates(reader, initial, "v", rig.initial_v, names, decided_by);

  auto disturbance = reader.table("disturbance", Need::kRequired);
  disturbance.number("reference_impulse_nms", rig.reference_impulse_nms, kPositive);
  disturbance.number("impulse_duration_s", rig.impulse_duration_s, kPositive);
  return rig;
}

std::vector<TomlReader::Key> rig_keys(const std::string& machine) {
  TomlReader reader("[rig]\nmachine = \"" + machine + "\"\n", "", {});
  read_rig(reader);  // all the rest is missing, which only finish() would mind
  return reader.keys();
}

}  // namespace gyrotwin
