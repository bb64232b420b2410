#include "clients/disturb/push.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

/// As the owner rounds it: to whole ticks, at least one.
std::int64_t whole_ticks(double duration_s, std::int64_t tick_ns) {
  const std::int64_t ns = std::llround(1e9 * duration_s);
  return std::max<std::int64_t>(1, (ns + tick_ns / 2) / tick_ns);
}

request_t request_of(std::int32_t kind, const Push& load, const Timing& timing,
                     std::int64_t duration_ns) {
  request_t request{};
  request.verb = request_t::DISTURB;
  request.disturbance = kind;
  std::ranges::copy(load.moment, request.moment_nm);
  std::ranges::copy(load.force, request.force_n);
  request.start_tick = timing.start_tick;
  request.duration_ns = duration_ns;
  return request;
}

}  // namespace

request_t impulse_request(const Push& impulse, const Timing& timing, std::int64_t tick_ns) {
  const std::int64_t duration_ns = whole_ticks(timing.duration_s, tick_ns) * tick_ns;
  const double duration = 1e-9 * static_cast<double>(duration_ns);
  Push load = impulse;
  for (double& moment : load.moment) moment /= duration;
  for (double& force : load.force) force /= duration;
  return request_of(request_t::IMPULSE, load, timing, duration_ns);
}

request_t load_request(const Push& load, const Timing& timing, std::int64_t tick_ns) {
  const std::int64_t duration_ns =
      timing.duration_s == 0.0 ? 0 : whole_ticks(timing.duration_s, tick_ns) * tick_ns;
  return request_of(request_t::STEP_LOAD, load, timing, duration_ns);
}

std::string describe(const Push& push, std::string_view unit_of_time) {
  constexpr std::array kAxes{"roll", "pitch", "yaw"};
  constexpr std::array kDirections{"x", "y", "z"};
  std::string text;
  const auto add = [&](double value, std::string_view unit, std::string_view where) {
    if (value == 0.0) return;
    text += fmt::format("{}{:g} {}{} {}", text.empty() ? "" : " and ", value, unit, unit_of_time,
                        where);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    add(push.moment[i], "N m", fmt::format("about {}", kAxes[i]));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    add(push.force[i], "N", fmt::format("along {}", kDirections[i]));
  }
  return text;
}

}  // namespace gyrotwin
