// Seeded runs of rigs that are about to fall, or not quite, and what was forecast meanwhile.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "services/onboard/noise.hpp"
#include "tests/support/mirrored_loop.hpp"

namespace gyrotwin::support {

/// What brings a rig to its limit; sizes are drawn between the two [as the kind has it].
struct Trouble {
  enum class Kind { kPush, kStep, kRamp, kGust, kController, kDrive, kRotors, kCalm };
  const char* name;
  const char* rig;
  Kind kind;
  double low, high;
};

inline const std::vector<Trouble>& troubles() {
  using enum Trouble::Kind;
  static const std::vector<Trouble> all{
      // Impulses [N m s], any direction that the rig feels.
      {"push", "double_brennan", kPush, 2.0, 6.0},
      {"push", "prototype_b_sleeping", kPush, 1.0, 4.0},
      {"push", "gyrocar", kPush, 1000.0, 3500.0},
      {"push", "brennan_monorail", kPush, 1e4, 6e4},
      // Moments that stay [N m], at once or growing for a second.
      {"step", "double_brennan", kStep, 2.0, 6.0},
      {"step", "prototype_b_sleeping", kStep, 2.0, 7.0},
      {"step", "gyrocar", kStep, 500.0, 2500.0},
      {"step", "brennan_monorail", kStep, 3e4, 7e4},
      {"ramp", "double_brennan", kRamp, 2.0, 6.0},
      {"ramp", "brennan_monorail", kRamp, 3e4, 7e4},
      // Root mean square [N m].
      {"gust", "double_brennan", kGust, 1.0, 4.0},
      {"gust", "gyrocar", kGust, 200.0, 1200.0},
      // After a push of this size [of the reference impulse].
      {"controller killed", "double_brennan", kController, 0.0, 1.0},
      {"controller killed", "brennan_monorail", kController, 0.0, 1.0},
      {"controller killed", "prototype_b", kController, 0.0, 1.0},
      // Share of the drives' torque that is left.
      {"drives weak", "double_brennan", kDrive, 0.0, 0.3},
      {"drives weak", "brennan_monorail", kDrive, 0.0, 0.3},
      // Share of the rotors' speed at the start, then half the reference impulse.
      {"rotors weak", "double_brennan", kRotors, 0.2, 0.7},
      {"calm", "double_brennan", kCalm, 0.0, 1.0},
      {"calm", "prototype_b", kCalm, 0.0, 1.0},
      {"calm", "brennan_monorail", kCalm, 0.0, 1.0},
  };
  return all;
}

/// One forecast as it was told.
struct Told {
  double at;  ///< when [s]
  forecast_t forecast;
};

/// How one run went; times of the owner [s].
struct Fate {
  double cause_at = 0.0;  ///< trouble begins
  double fell_at = -1.0;  ///< FALLEN; < 0: never
  double peak_tilt = 0.0;
  std::vector<Told> told;
};

constexpr double kCauseAt = 1.6;     // [s]
constexpr double kRunUntil = 6.2;    // [s]
constexpr double kQuietUntil = 4.1;  // what comes later would be forecast beyond the end [s]

/// @param seed of size, direction, sensors and gusts
inline Fate run_trouble(const Trouble& trouble, std::uint64_t seed,
                        const ForecastSettings& settings = {}) {
  using enum Trouble::Kind;
  const auto draw = [&](std::uint64_t stream) { return uniform(seed, stream, 0); };
  const double size = trouble.low + draw(1) * (trouble.high - trouble.low);
  std::vector<std::string> overrides{"loop.state=estimate", "sensors.seed=" + std::to_string(seed)};
  if (trouble.kind == kRotors) {
    overrides.push_back("rotor_drive.start_share=" + std::to_string(size));
    // Too weak a motor to spin them up again.
    overrides.push_back("rotor_drive.time_constant_s=100");
  }
  MirroredLoop loop(load_rig(trouble.rig, overrides), settings);
  loop.hear();
  loop.ask(request_t::ARM);

  Fate run;
  const auto tick = [&] {
    loop.tick();
    const double now = 1e-9 * static_cast<double>(loop.state.header.sim_time_ns);
    if (loop.forecast_told) run.told.push_back({now, loop.forecast});
    run.peak_tilt = std::max(run.peak_tilt, loop.tilt());
    if (run.fell_at < 0.0 && loop.integrator.mode() == Mode::kFallen) {
      run.fell_at = now + loop.rig.loop.tick_s();
    }
    return run.fell_at < 0.0 && now < kRunUntil;
  };
  // At an instant of its own, so that it does not always meet the same phase.
  run.cause_at = kCauseAt + 0.1 * draw(2);
  for (auto n = std::llround(run.cause_at * loop.rig.loop.rate_hz); n > 0; --n) {
    if (!tick()) return run;
  }

  const model::Machine& machine = loop.integrator.plant().machine();
  const double angle = machine.layout.tilts() > 1 ? 6.283185307179586 * draw(3)
                                                  : (draw(3) < 0.5 ? 0.0 : 3.141592653589793);
  request_t request{};
  request.verb = request_t::DISTURB;
  request.kind = request_t::LOAD;
  double moment = size;
  const double reference = loop.rig.reference_impulse_nms / loop.rig.impulse_duration_s;
  const auto impulse_ns = std::llround(1e9 * loop.rig.impulse_duration_s);
  switch (trouble.kind) {
    case kPush:
      moment = size / loop.rig.impulse_duration_s;
      request.duration_ns = impulse_ns;
      break;
    case kStep:
      break;
    case kRamp:
      request.rise_ns = 1'000'000'000;
      break;
    case kGust:
      request.kind = request_t::GUST;
      request.correlation_s = 0.1 + 0.9 * draw(4);
      request.seed = static_cast<std::int64_t>(seed);
      break;
    case kController:
      moment = size * reference;
      request.duration_ns = impulse_ns;
      break;
    case kDrive:
    case kRotors:
      moment = 0.5 * reference;
      request.duration_ns = impulse_ns;
      break;
    case kCalm:
      moment = 0.3 * size * reference;
      request.duration_ns = impulse_ns;
      break;
  }
  request.moment_nm[0] = moment * std::cos(angle);
  request.moment_nm[1] = machine.layout.tilts() > 1 ? moment * std::sin(angle) : 0.0;
  if (moment != 0.0) loop.ask(request);
  if (trouble.kind == kController) loop.controller_alive = false;
  if (trouble.kind == kDrive) {
    request_t fault{};
    fault.verb = request_t::FAULT;
    fault.kind = request_t::DRIVE_WEAK;
    fault.target = -1;
    fault.level = size;
    loop.ask(fault);
  }
  while (tick()) {
  }
  return run;
}

/// By how much the alarm that stood until the fall came before it [s]; < 0: there was none.
inline double lead(const Fate& run) {
  double since = -1.0;
  for (const Told& told : run.told) {
    const bool falls = told.forecast.outcome == forecast_t::FALLS;
    if (falls && since < 0.0) since = told.at;
    if (!falls) since = -1.0;
  }
  return since < 0.0 ? -1.0 : run.fell_at - since;
}

/// In a run that never falls.
inline bool false_alarm(const Fate& run) {
  return run.fell_at < 0.0 && std::ranges::any_of(run.told, [](const Told& told) {
           return told.at < kQuietUntil && told.forecast.outcome == forecast_t::FALLS;
         });
}

}  // namespace gyrotwin::support
