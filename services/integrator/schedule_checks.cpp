#include "services/integrator/schedule_checks.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <string_view>

#include "services/runtime/refuse.hpp"

namespace gyrotwin {

namespace {

using Eigen::Vector3d;

constexpr double kLongest = 3600.0;  // duration [s]
constexpr double kStrongest = 1e9;   // [N], [N m], and the unit of any sensor
constexpr double kFastest = 1000.0;  // [m/s], [m/s^2]

// Kinds of both verbs as bits.
constexpr std::uint32_t disturb(std::int32_t kind) { return 1u << kind; }
constexpr std::uint32_t fault(std::int32_t kind) { return 1u << (16 + kind); }
constexpr std::uint32_t kLoads = disturb(request_t::LOAD) | disturb(request_t::SINE) |
                                 disturb(request_t::CHIRP) | disturb(request_t::GUST);
constexpr std::uint32_t kWind = disturb(request_t::WIND), kTurn = disturb(request_t::TURN);
constexpr std::uint32_t kSlowing = disturb(request_t::DECELERATION);
constexpr std::uint32_t kMass = disturb(request_t::ADDED_MASS);
constexpr std::uint32_t kSensor = fault(request_t::SENSOR_STUCK) | fault(request_t::SENSOR_BIASED) |
                                  fault(request_t::SENSOR_NOISY) |
                                  fault(request_t::SENSOR_DROPPED) |
                                  fault(request_t::SENSOR_DELAYED);
constexpr std::uint32_t kIndexed = fault(request_t::DRIVE_WEAK) | fault(request_t::ROTOR_LOSS);

bool is_disturbance(const request_t& r) { return r.verb == request_t::DISTURB; }

std::string_view name_of_kind(const request_t& r) {
  constexpr std::array<std::string_view, 8> kDisturbances{
      "LOAD", "SINE", "CHIRP", "GUST", "WIND", "TURN", "DECELERATION", "ADDED_MASS"};
  constexpr std::array<std::string_view, 8> kFaults{
      "SENSOR_STUCK",   "SENSOR_BIASED", "SENSOR_NOISY", "SENSOR_DROPPED",
      "SENSOR_DELAYED", "DRIVE_WEAK",    "ROTOR_LOSS",   "COMMAND_LOST"};
  return (is_disturbance(r) ? kDisturbances : kFaults)[static_cast<std::size_t>(r.kind - 1)];
}

template <std::size_t N>
bool given(const double (&x)[N]) {
  return std::any_of(std::begin(x), std::end(x), [](double value) { return value != 0.0; });
}
bool given(double x) { return x != 0.0; }
bool given(std::int64_t x) { return x != 0; }

/// A number that would be ignored is a mistake of the asker.
bool only_its_own_fields(const request_t& r, reply_t& reply) {
  const std::uint32_t kind = is_disturbance(r) ? disturb(r.kind) : fault(r.kind);
  struct Field {
    std::string_view name;
    bool given;
    std::uint32_t kinds;  // that have it
  };
  const Field fields[] = {
      {"rise_ns", given(r.rise_ns), kLoads | kWind | kTurn | kSlowing},
      {"seed", given(r.seed), disturb(request_t::GUST) | kWind | fault(request_t::SENSOR_NOISY)},
      {"force_n", given(r.force_n), kLoads},
      {"moment_nm", given(r.moment_nm), kLoads},
      {"frequency_hz[0]", given(r.frequency_hz[0]),
       disturb(request_t::SINE) | disturb(request_t::CHIRP)},
      {"frequency_hz[1]", given(r.frequency_hz[1]), disturb(request_t::CHIRP)},
      {"speed_m_s", given(r.speed_m_s), kWind | kTurn},
      {"direction_rad", given(r.direction_rad), kWind},
      {"turbulence_m_s", given(r.turbulence_m_s), kWind},
      {"length_m", given(r.length_m), kWind},
      {"correlation_s", given(r.correlation_s), disturb(request_t::GUST)},
      {"yaw_rate_rad_s", given(r.yaw_rate_rad_s), kTurn},
      {"deceleration_m_s2", given(r.deceleration_m_s2), kSlowing},
      {"mass_kg", given(r.mass_kg), kMass},
      {"position_m", given(r.position_m), kMass},
      {"level", given(r.level),
       fault(request_t::SENSOR_BIASED) | fault(request_t::SENSOR_NOISY) | kIndexed},
      {"delay_ns", given(r.delay_ns), fault(request_t::SENSOR_DELAYED)},
      {"target", given(std::int64_t{r.target}), kSensor | kIndexed},
  };
  for (const Field& field : fields) {
    if (field.given && (field.kinds & kind) == 0) {
      return refuse(reply, "{} has no {}; leave it 0", name_of_kind(r), field.name);
    }
  }
  return true;
}

/// Catches what is not finite, too.
bool within(reply_t& reply, std::string_view name, double x, double low, double high) {
  if (x >= low && x <= high) return true;
  return refuse(reply, "{} must be {} to {}", name, low, high);
}

template <std::size_t N>
bool all_within(reply_t& reply, std::string_view name, const double (&x)[N], double limit) {
  return std::all_of(std::begin(x), std::end(x),
                     [&](double value) { return within(reply, name, value, -limit, limit); });
}

/// For what does nothing at 0.
bool positive(reply_t& reply, std::string_view name, double x, double high) {
  if (x > 0.0 && x <= high) return true;
  return refuse(reply, "{} must be more than 0, up to {}", name, high);
}

/// Whether any coordinate, somewhere off the upright, moves differently for this input.
bool felt(const model::Machine& machine, const model::Input& input) {
  model::State state;
  for (int i = 0; i < machine.coordinates(); ++i) state.q[i] = 0.05 * (i + 1);
  state.rotor_speed = machine.nominal_rotor_speed;
  const model::Coordinates alone = machine.acceleration(state, {});
  const model::Coordinates moved = machine.acceleration(state, input);
  return (moved - alone).cwiseAbs().maxCoeff() > 1e-9 * (1.0 + alone.cwiseAbs().maxCoeff());
}

double total_mass(const model::Machine& machine) {
  double mass = 0.0;
  for (int b = 0; b < machine.tree.shape().bodies.size; ++b) mass += machine.tree.mass(b);
  return mass;
}

bool force_felt(const model::Machine& machine, const Vector3d& direction, const Vector3d& arm) {
  model::Input probe;
  probe.force = total_mass(machine) * machine.gravity * direction;
  probe.moment = arm.cross(probe.force);
  return felt(machine, probe);
}

bool moment_felt(const model::Machine& machine, const Vector3d& axis) {
  model::Input probe;
  probe.moment = total_mass(machine) * machine.gravity * axis;
  return felt(machine, probe);
}

bool check_load(const request_t& r, const model::Machine& machine, reply_t& reply) {
  if (!all_within(reply, "force_n", r.force_n, kStrongest) ||
      !all_within(reply, "moment_nm", r.moment_nm, kStrongest)) {
    return false;
  }
  if (!given(r.force_n) && !given(r.moment_nm)) {
    return refuse(reply, "{} needs a force_n or a moment_nm", name_of_kind(r));
  }
  for (int i = 0; i < 3; ++i) {
    const char axis = "xyz"[i];
    if (given(r.force_n[i]) && !force_felt(machine, Vector3d::Unit(i), Vector3d::Zero())) {
      return refuse(reply, "nothing on this machine can give way to a force along {}", axis);
    }
    if (given(r.moment_nm[i]) && !moment_felt(machine, Vector3d::Unit(i))) {
      return refuse(reply, "nothing on this machine can give way to a moment about {}", axis);
    }
  }
  return true;
}

bool check_frequencies(const request_t& r, const Rig& rig, reply_t& reply) {
  const double nyquist = 0.5 / rig.loop.tick_s();
  if (r.kind == request_t::SINE)
    return positive(reply, "frequency_hz[0]", r.frequency_hz[0], nyquist);
  if (r.duration_ns == 0) return refuse(reply, "CHIRP needs a duration_ns to sweep over");
  return within(reply, "frequency_hz[0]", r.frequency_hz[0], 0.0, nyquist) &&
         within(reply, "frequency_hz[1]", r.frequency_hz[1], 0.0, nyquist);
}

bool check_wind(const request_t& r, const Rig& rig, const model::Machine& machine, reply_t& reply) {
  if (!rig.wind) {
    return refuse(reply,
                  "this rig has no [wind]; give its file area_m2, drag_coefficient and "
                  "pressure_height_m");
  }
  if (!positive(reply, "speed_m_s", r.speed_m_s, kFastest) ||
      !within(reply, "direction_rad", r.direction_rad, -10.0, 10.0) ||
      !within(reply, "turbulence_m_s", r.turbulence_m_s, 0.0, kFastest) ||
      !within(reply, "length_m", r.length_m, 0.0, 1e6)) {
    return false;
  }
  if (given(r.turbulence_m_s) != given(r.length_m)) {
    return refuse(reply, "turbulence needs both turbulence_m_s and length_m");
  }
  const Vector3d along(std::cos(r.direction_rad), std::sin(r.direction_rad), 0.0);
  const Vector3d across(-along.y(), along.x(), 0.0);
  const Vector3d arm = Vector3d(0.0, 0.0, rig.wind->pressure_height) - machine.push_point;
  if (force_felt(machine, along, arm)) return true;
  if (given(r.turbulence_m_s) && force_felt(machine, across, arm)) return true;
  return refuse(reply,
                "nothing on this machine can give way to wind from there; turn direction_rad");
}

bool check_turn(const request_t& r, const model::Machine& machine, reply_t& reply) {
  if (!within(reply, "speed_m_s", r.speed_m_s, -kFastest, kFastest) ||
      !within(reply, "yaw_rate_rad_s", r.yaw_rate_rad_s, -100.0, 100.0)) {
    return false;
  }
  if (!given(r.yaw_rate_rad_s)) return refuse(reply, "TURN needs a yaw_rate_rad_s");
  model::Input probe;
  probe.yaw_rate = 1.0;
  if (given(r.speed_m_s)) probe.ground_acceleration.y() = machine.gravity;
  return felt(machine, probe) || refuse(reply, "nothing on this machine feels a turn");
}

bool check_deceleration(const request_t& r, const model::Machine& machine, reply_t& reply) {
  if (!within(reply, "deceleration_m_s2", r.deceleration_m_s2, -kFastest, kFastest)) return false;
  if (!given(r.deceleration_m_s2)) return refuse(reply, "DECELERATION needs a deceleration_m_s2");
  model::Input probe;
  probe.ground_acceleration.x() = machine.gravity;
  return felt(machine, probe) ||
         refuse(reply, "nothing on this machine can give way to a deceleration along x");
}

bool check_mass(const request_t& r, const model::Machine& machine, reply_t& reply) {
  if (!positive(reply, "mass_kg", r.mass_kg, 1e6) ||
      !all_within(reply, "position_m", r.position_m, 1000.0)) {
    return false;
  }
  model::Input probe;
  probe.added.add({total_mass(machine), Eigen::Map<const Vector3d>(r.position_m)});
  return felt(machine, probe) ||
         refuse(reply, "a mass there moves with nothing; put it off the pivot");
}

bool check_disturbance(const request_t& r, const Rig& rig, const model::Machine& machine,
                       reply_t& reply) {
  switch (r.kind) {
    case request_t::LOAD:
      return check_load(r, machine, reply);
    case request_t::SINE:
    case request_t::CHIRP:
      return check_frequencies(r, rig, reply) && check_load(r, machine, reply);
    case request_t::GUST:
      return positive(reply, "correlation_s", r.correlation_s, kLongest) &&
             check_load(r, machine, reply);
    case request_t::WIND:
      return check_wind(r, rig, machine, reply);
    case request_t::TURN:
      return check_turn(r, machine, reply);
    case request_t::DECELERATION:
      return check_deceleration(r, machine, reply);
    default:
      return check_mass(r, machine, reply);
  }
}

bool check_sensor(const request_t& r, std::int32_t sensors, reply_t& reply) {
  const auto target = static_cast<std::uint32_t>(r.target);
  if (std::popcount(target) != 1 || r.target > sensors_t::VALID_ESTOP || r.target < 0) {
    return refuse(reply, "target must be one VALID_* of sensors_t");
  }
  if (sensors == 0) return refuse(reply, "this rig has no [sensors]; give its file the table");
  if ((sensors & r.target) == 0) return refuse(reply, "this rig has no such sensor to fail");
  const bool number = r.kind == request_t::SENSOR_BIASED || r.kind == request_t::SENSOR_NOISY;
  if (number && r.target == sensors_t::VALID_ESTOP) {
    return refuse(reply, "an E-stop is no number; let it be stuck, dropped or delayed");
  }
  if (r.kind == request_t::SENSOR_BIASED) {
    return within(reply, "level", r.level, -kStrongest, kStrongest) &&
           (given(r.level) || refuse(reply, "SENSOR_BIASED needs a level"));
  }
  if (r.kind == request_t::SENSOR_NOISY) return positive(reply, "level", r.level, kStrongest);
  if (r.kind == request_t::SENSOR_DELAYED) {
    return positive(reply, "delay_ns", static_cast<double>(r.delay_ns), 1e9 * kLongestDelay);
  }
  return true;
}

bool check_index(const request_t& r, std::string_view what, std::size_t count, reply_t& reply) {
  if (r.target >= -1 && r.target < static_cast<std::int64_t>(count)) return true;
  return refuse(reply, "target {}: this machine has {} {}; count from 0, -1 means all", r.target,
                count, what);
}

bool check_fault(const request_t& r, const model::Machine& machine, std::int32_t sensors,
                 reply_t& reply) {
  switch (r.kind) {
    case request_t::DRIVE_WEAK:
      if (!check_index(r, "drives", machine.drives.size(), reply)) return false;
      if (r.level >= 0.0 && r.level < 1.0) return true;
      return refuse(reply, "level, the share of the torque that is left, must be 0 to less than 1");
    case request_t::ROTOR_LOSS:
      if (!machine.rotor_drive) {
        return refuse(reply, "rotors of this rig keep their speed; give its file [rotor_drive]");
      }
      return check_index(r, "rotors", static_cast<std::size_t>(machine.rotors), reply) &&
             within(reply, "level", r.level, 0.0, kStrongest);
    case request_t::COMMAND_LOST:
      return true;
    default:
      return check_sensor(r, sensors, reply);
  }
}

bool check_times(const request_t& r, reply_t& reply) {
  constexpr auto kLongestNs = static_cast<std::int64_t>(kLongest * 1e9);
  if (r.duration_ns < 0 || r.duration_ns > kLongestNs) {
    return refuse(reply, "duration_ns must be 0 (until it is cancelled) to {} s", kLongest);
  }
  if (r.rise_ns < 0 || r.rise_ns > kLongestNs) {
    return refuse(reply, "rise_ns must be 0 to {} s", kLongest);
  }
  if (r.duration_ns != 0 && r.rise_ns > r.duration_ns) {
    return refuse(reply, "rise_ns is longer than duration_ns; it would never have risen");
  }
  if (r.start_tick < 0) return refuse(reply, "start_tick must be 0 (the next one) or a tick");
  return true;
}

}  // namespace

bool check_request(const request_t& request, const Rig& rig, const model::Machine& machine,
                   std::int32_t sensors, reply_t& reply) noexcept {
  const std::int32_t last =
      is_disturbance(request) ? +request_t::ADDED_MASS : +request_t::COMMAND_LOST;
  if (request.kind < 1 || request.kind > last) {
    return refuse(reply, "kind {} of {} is not known to this owner", request.kind,
                  is_disturbance(request) ? "DISTURB" : "FAULT");
  }
  if (!only_its_own_fields(request, reply) || !check_times(request, reply)) return false;
  return is_disturbance(request) ? check_disturbance(request, rig, machine, reply)
                                 : check_fault(request, machine, sensors, reply);
}

}  // namespace gyrotwin
