#include "clients/common/request_words.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "clients/common/tilt.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kPercent = 100.0;

std::string vector_text(std::string_view what, const double (&v)[3], std::string_view unit) {
  const bool none = std::all_of(std::begin(v), std::end(v), [](double x) { return x == 0.0; });
  if (none) return {};
  return fmt::format(" {} ({:.4g}, {:.4g}, {:.4g}) {}", what, v[0], v[1], v[2], unit);
}

std::string load(const request_t& r) {
  return vector_text("moment", r.moment_nm, "N m") + vector_text("force", r.force_n, "N");
}

std::string wind(const request_t& r) {
  std::string text =
      fmt::format("wind {:.4g} m/s towards {:.4g} deg", r.speed_m_s, degrees(r.direction_rad));
  if (r.turbulence_m_s != 0.0) text += fmt::format(", turbulence {:.4g} m/s", r.turbulence_m_s);
  return text;
}

std::string disturbance(const request_t& r) {
  switch (r.kind) {
    case request_t::LOAD:
      return "load:" + load(r);
    case request_t::SINE:
      return fmt::format("sine {:.4g} Hz:{}", r.frequency_hz[0], load(r));
    case request_t::CHIRP:
      return fmt::format("chirp {:.4g} to {:.4g} Hz:{}", r.frequency_hz[0], r.frequency_hz[1],
                         load(r));
    case request_t::GUST:
      return "gust:" + load(r) + " rms";
    case request_t::WIND:
      return wind(r);
    case request_t::TURN:
      return fmt::format("turn: {:.4g} m/s, {:.4g} rad/s", r.speed_m_s, r.yaw_rate_rad_s);
    case request_t::DECELERATION:
      return fmt::format("brake: {:.4g} m/s^2", r.deceleration_m_s2);
    case request_t::ADDED_MASS:
      return fmt::format("mass {:.4g} kg:{}", r.mass_kg, vector_text("at", r.position_m, "m"));
    default:
      return fmt::format("disturbance of unknown kind {}", r.kind);
  }
}

std::string_view sensor_name(std::int32_t valid) {
  switch (valid) {
    case sensors_t::VALID_GYRO:
      return "gyro";
    case sensors_t::VALID_ACCELEROMETER:
      return "acceleration";
    case sensors_t::VALID_DISC:
      return "disc sensor";
    case sensors_t::VALID_GIMBALS:
      return "gimbal sensors";
    case sensors_t::VALID_ROTORS:
      return "rotor sensors";
    case sensors_t::VALID_CURRENTS:
      return "current sensors";
    case sensors_t::VALID_BUS_VOLTAGE:
      return "voltage sensor";
    case sensors_t::VALID_LOAD_CELL:
      return "load cell";
    default:
      return "unknown sensor";
  }
}

/// "drive 0", "all drives".
std::string numbered(std::string_view what, std::int32_t target) {
  return target < 0 ? fmt::format("all {}s", what) : fmt::format("{} {}", what, target);
}

std::string fault(const request_t& r) {
  switch (r.kind) {
    case request_t::SENSOR_STUCK:
      return fmt::format("{} stuck", sensor_name(r.target));
    case request_t::SENSOR_BIASED:
      return fmt::format("{} off by {:.4g}", sensor_name(r.target), r.level);
    case request_t::SENSOR_NOISY:
      return fmt::format("{} noisy by {:.4g}", sensor_name(r.target), r.level);
    case request_t::SENSOR_DROPPED:
      return fmt::format("{} not heard", sensor_name(r.target));
    case request_t::SENSOR_DELAYED:
      return fmt::format("{} late by {:.4g} s", sensor_name(r.target),
                         1e-9 * static_cast<double>(r.delay_ns));
    case request_t::DRIVE_WEAK:
      return fmt::format("{}: {:.3g} % left", numbered("drive", r.target), kPercent * r.level);
    case request_t::ROTOR_LOSS:
      return fmt::format("{}: no power, brake {:.4g} N m", numbered("rotor", r.target), r.level);
    case request_t::COMMAND_LOST:
      return "commands lost";
    default:
      return fmt::format("fault of unknown kind {}", r.kind);
  }
}

}  // namespace

std::string describe(const request_t& request) {
  return request.verb == request_t::FAULT ? fault(request) : disturbance(request);
}

}  // namespace gyrotwin
