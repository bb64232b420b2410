#include "services/runtime/rig_reader.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "services/runtime/law_keys.hpp"
#include "services/runtime/machine_reader.hpp"

namespace gyrotwin {

namespace {

constexpr std::array<Word<ClockMode>, 3> kClockWords{{{"realtime", ClockMode::kRealtime},
                                                      {"lockstep", ClockMode::kLockstep},
                                                      {"free", ClockMode::kFree}}};

constexpr std::array<Word<StateSource>, 2> kStateWords{
    {{"truth", StateSource::kTruth}, {"estimate", StateSource::kEstimate}}};

constexpr std::array<Word<Wave>, 2> kWaveWords{{{"sine", Wave::kSine}, {"relay", Wave::kRelay}}};

constexpr std::array<Word<OverrunPolicy>, 2> kOverrunWords{
    {{"skip", OverrunPolicy::kSkip}, {"stop", OverrunPolicy::kStop}}};

constexpr std::array<Word<SafeStopDrive>, 3> kSafeStopWords{
    {{"zero_torque", SafeStopDrive::kZeroTorque},
     {"brake", SafeStopDrive::kBrake},
     {"hold_speed", SafeStopDrive::kHoldSpeed}}};

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

constexpr TextRule kDevice{
    "an absolute path, e.g. /dev/ttyACM0, or empty",
    [](const std::string& t) { return t.empty() || (t.front() == '/' && t.size() < 256); }};

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
  table.word("state", loop.state, kStateWords);
  table.integer("command_delay_ticks", loop.command_delay_ticks, {0, Rig::Loop::kMaxCommandDelay});
  table.word("overrun", loop.overrun, kOverrunWords);
  table.number("patience_s", loop.patience_s, {0, 10});
  table.integer("spin_us", loop.spin_us, {0, Rig::Loop::kMaxSpin});
  if (2 * loop.spin_us > 1e6 / loop.rate_hz) {
    reader.mistake({"loop.spin_us", "loop.rate_hz"},
                   "a tick may spin for half its time at most: set `loop.spin_us` to " +
                       std::to_string(loop.tick_ns() / 2000) + " or less, or lower `loop.rate_hz`");
  }
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

void read_controller(TomlReader& reader, Rig& rig) {
  Rig::Controller& controller = rig.controller;
  auto table = reader.table("controller", Need::kOptional);
  table.word("law", controller.law, kLawWords);
  table.word("wave", controller.wave, kWaveWords);
  table.numbers("gain", controller.gain);
  for (const LawNumber& number : law_numbers()) {
    table.number(number.key, controller.*number.value, number.range);
  }

  const std::string why_not = misfit(rig);
  if (!why_not.empty()) return reader.mistake({"controller.law", "rig.machine"}, why_not);
  const std::string law(name_of(controller.law));
  for (const auto& [key, unless_gain] : missing_numbers(controller)) {
    reader.need("controller." + std::string(key),
                "law " + law + (unless_gain ? " needs it or `controller.gain`" : " needs it"));
  }
}

/// `initial` q or v: one number per coordinate.
void read_coordinates(TomlReader& reader, TomlReader::Table& table, const char* key,
                      std::vector<double>& values, const CoordinateNames& names,
                      const std::string& decided_by) {
  if (!table.numbers(key, values) || values.size() == names.size()) return;
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  const std::string path = std::string("initial.") + key;
  reader.mistake({path, decided_by}, '`' + path + "` has " + std::to_string(values.size()) +
                                         " numbers, expected " + std::to_string(names.size()) +
                                         ": (" + list + "), as `" + decided_by + "` says");
}

/// A table that may be left out whole; there, all its keys are needed. @return null: left out
std::optional<TomlReader::Table> table_if_there(TomlReader& reader, const char* name, Need need) {
  const bool there = reader.has_table(name);
  auto table = reader.table(name, need);
  return there ? std::optional(table) : std::nullopt;
}

double nominal_rotor_speed(const Rig& rig) {
  const auto speed = [](const auto& machine) {
    if constexpr (requires { machine.gyros; }) return std::abs(machine.gyros.rotor_speed);
    if constexpr (requires { machine.gyro; }) return std::abs(machine.gyro.rotor_speed);
  };
  return std::visit(speed, rig.machine);
}

void read_rotor_drive(TomlReader& reader, Rig& rig) {
  auto table = table_if_there(reader, "rotor_drive", Need::kRequired);
  if (!table) return;
  model::RotorDrive& drive = rig.rotor_drive.emplace();
  table->number("power_limit_w", drive.power_limit, kPositive);
  table->number("torque_limit_nm", drive.torque_limit, kPositive);
  table->number("time_constant_s", drive.time_constant, kPositive);
  table->number("viscous_drag_nms_per_rad", drive.viscous_drag, kNotNegative);
  table->number("coulomb_drag_nm", drive.coulomb_drag, kNotNegative);
  table->number("start_share", rig.initial_rotor_share, {0, 1});

  const double speed = nominal_rotor_speed(rig);
  const double drag = drive.viscous_drag * speed + drive.coulomb_drag;
  const auto check = [&](const char* key, double limit, double least, const char* unit) {
    if (!(limit < least)) return;  // nor where a number is missing
    reader.mistake({key}, '`' + std::string(key) + "` must be at least " + rounded(least) + ' ' +
                              unit + ", what the drag takes at the nominal rotor speed");
  };
  check("rotor_drive.torque_limit_nm", drive.torque_limit, drag, "N m");
  check("rotor_drive.power_limit_w", drive.power_limit, drag * speed, "W");
}

constexpr double kLargestLean = 0.7;  // [rad]

void read_load_cell(TomlReader& reader, Rig& rig) {
  auto table = table_if_there(reader, "load_cell", Need::kRequired);
  if (!table) return;
  model::LoadCell& cell = rig.load_cell.emplace();
  double height = 0.0, direction = 0.0, lean = 0.0;
  table->number("height_m", height, kPositive);
  table->number("direction_rad", direction, kAnyNumber);
  table->number("lean_rad", lean, {-kLargestLean, kLargestLean});
  table->number("stiffness_n_per_m", cell.stiffness, kPositive);
  table->number("damping_ns_per_m", cell.damping, kNotNegative);
  cell.point = {0.0, 0.0, height};
  cell.direction = {std::cos(direction), std::sin(direction), 0.0};
  cell.rest = height * std::sin(lean);
}

void read_wind(TomlReader& reader, Rig& rig) {
  auto table = table_if_there(reader, "wind", Need::kRequired);
  if (!table) return;
  Rig::Wind& wind = *(rig.wind = Rig::Wind{});
  table->number("area_m2", wind.area, kPositive);
  table->number("drag_coefficient", wind.drag_coefficient, kPositive);
  table->number("pressure_height_m", wind.pressure_height, kAnyNumber);
}

/// Three numbers, or none at all.
void read_vector(TomlReader& reader, TomlReader::Table& table, const std::string& table_name,
                 const char* key, Eigen::Vector3d& value) {
  std::vector<double> numbers{value.x(), value.y(), value.z()};
  if (!table.numbers(key, numbers)) return;
  if (numbers.size() == 3) {
    value = Eigen::Vector3d::Map(numbers.data());
    return;
  }
  const std::string path = table_name + "." + key;
  reader.mistake({path}, "`" + path + "` has " + std::to_string(numbers.size()) +
                             " numbers, expected 3: (x, y, z)");
}

void read_imperfection(TomlReader::Table& table, const std::string& sensor, const std::string& unit,
                       Imperfection& imperfection) {
  const auto read = [&](const char* what, double& value) {
    table.number((sensor + "_" + what + "_" + unit).c_str(), value, kNotNegative);
  };
  read("noise", imperfection.noise);
  read("bias", imperfection.bias);
  read("resolution", imperfection.resolution);
}

void read_sensors(TomlReader& reader, Rig& rig) {
  auto given = table_if_there(reader, "sensors", Need::kOptional);
  if (!given) return;
  TomlReader::Table& table = *given;
  Rig::Sensors& sensors = *(rig.sensors = Rig::Sensors{});
  read_vector(reader, table, "sensors", "imu_position_m", sensors.imu_position);
  read_vector(reader, table, "sensors", "imu_orientation_rad", sensors.imu_orientation);
  read_imperfection(table, "gyro", "rad_s", sensors.gyro);
  read_imperfection(table, "acceleration", "m_s2", sensors.acceleration);
  read_imperfection(table, "disc", "rad", sensors.disc);
  read_imperfection(table, "gimbal", "rad", sensors.gimbal);
  read_imperfection(table, "rotor", "rad_s", sensors.rotor);
  read_imperfection(table, "current", "a", sensors.current);
  read_imperfection(table, "voltage", "v", sensors.voltage);
  read_imperfection(table, "load_cell", "n", sensors.load_cell);
  table.integer("delay_ticks", sensors.delay_ticks, {0, Rig::Sensors::kMaxDelay});
  table.integer("seed", sensors.seed, {0, 999'999});
}

void read_estimator(TomlReader& reader, Rig& rig) {
  auto estimator = reader.table("estimator", Need::kOptional);
  estimator.number("tilt_bandwidth_rad_s", rig.estimator.tilt, kPositive);
  estimator.number("gyro_bias_bandwidth_rad_s", rig.estimator.gyro_bias, kNotNegative);
  estimator.number("disc_bandwidth_rad_s", rig.estimator.disc, kPositive);
  estimator.number("gimbal_bandwidth_rad_s", rig.estimator.gimbal, kPositive);
  if (rig.loop.state == StateSource::kEstimate && !rig.sensors) {
    reader.mistake({"loop.state"},
                   "an estimate needs sensors: add a table [sensors], or set "
                   "`loop.state = \"truth\"`");
  }
}

void read_mirror(TomlReader& reader, Rig::Mirror& mirror) {
  auto table = reader.table("mirror", Need::kOptional);
  table.number("moment_walk_share", mirror.moment_walk, kPositive);
  table.number("friction_walk_share", mirror.friction_walk, kNotNegative);
  table.number("model_noise_share", mirror.model_noise, kNotNegative);
  table.number("inertia_spread", mirror.inertia_spread, {0, 1});
  table.number("drive_spread", mirror.drive_spread, {0, 1});
}

}  // namespace

Rig read_rig(TomlReader& reader) {
  Rig rig;
  auto identity = reader.table("rig", Need::kRequired);
  identity.text("name", rig.name, kName);
  identity.text("summary", rig.summary, kSentence);
  identity.integer("id", rig.id, {1, 255});

  read_network(reader, rig.network);
  read_loop(reader, rig.loop);
  rig.machine = read_machine(reader, identity);
  read_safety(reader, rig.safety, std::holds_alternative<model::UmbrellaParameters>(rig.machine));
  read_controller(reader, rig);
  read_rotor_drive(reader, rig);
  if (!std::holds_alternative<model::GyroscopeParameters>(rig.machine)) {
    read_load_cell(reader, rig);
    read_wind(reader, rig);
  }
  read_sensors(reader, rig);
  read_estimator(reader, rig);
  read_mirror(reader, rig.mirror);
  auto hardware = reader.table("hardware", Need::kOptional);
  hardware.text("device", rig.hardware.device, kDevice);
  hardware.integer("baud", rig.hardware.baud, kNotNegative);

  const CoordinateNames names = coordinate_names(rig.machine);
  auto initial = reader.table("initial", Need::kRequired);
  read_coordinates(reader, initial, "q", rig.initial_q, names, machine_key(rig.machine));
  read_coordinates(reader, initial, "v", rig.initial_v, names, machine_key(rig.machine));

  auto disturbance = reader.table("disturbance", Need::kRequired);
  disturbance.number("reference_impulse_nms", rig.reference_impulse_nms, kPositive);
  disturbance.number("impulse_duration_s", rig.impulse_duration_s, kPositive);
  return rig;
}

std::vector<TomlReader::Key> rig_keys(const std::string& machine) {
  TomlReader reader(
      "[rig]\nmachine = \"" + machine + "\"\n[rotor_drive]\n[load_cell]\n[wind]\n[sensors]\n", "",
      {});
  read_rig(reader);  // all the rest is missing, which only finish() would mind
  return reader.keys();
}

}  // namespace gyrotwin
