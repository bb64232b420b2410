// The tables of services/mirror/README.md:
//   mirror_figures times            work of a step, median of a second
//   mirror_figures faults RUNS      how long until each fault is named, over so many seeds
//   mirror_figures alarms SECONDS   verdicts on rigs that are as modelled; exit 1 if one changes
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/twin_bench.hpp"

namespace gyrotwin {
namespace {

using support::TwinBench;

const std::vector<std::string> kRigs{"prototype_b", "prototype_b_sleeping", "double_brennan",
                                     "brennan_monorail", "gyrocar"};

std::vector<std::string> on_estimate(int seed) {
  return {"loop.state=estimate", "sensors.seed=" + std::to_string(seed)};
}

int print_times() {
  std::printf("| rig | median | 90 %% |\n|---|---|---|\n");
  for (const std::string& name : shipped_rigs()) {
    TwinBench bench(name);
    bench.run(0.2);
    std::vector<double> times;
    Follower follower(bench.rig, bench.machine);
    follower.start(bench.sensors);
    for (int k = 0; k < 1000 && bench.step(); ++k) {
      const auto begin = std::chrono::steady_clock::now();
      follower.step(bench.sensors, bench.commanded);
      bench.health.take(follower, bench.sensors, bench.commanded);
      const std::chrono::duration<double, std::micro> time =
          std::chrono::steady_clock::now() - begin;
      times.push_back(time.count());
    }
    std::sort(times.begin(), times.end());
    std::printf("| `%s` | %.0f us | %.0f us |\n", name.c_str(), times[times.size() / 2],
                times[times.size() * 9 / 10]);
  }
  return 0;
}

struct Fault {
  const char* what;
  std::int32_t kind, target;
  double level, delay_s;
  double push;         ///< of the reference impulse, 1 s after it; the time counts from there
  std::int32_t blame;  ///< with its index, or with the verdict of the sensor
  std::int32_t detail;
};

std::vector<Fault> faults() {
  using R = request_t;
  using S = sensors_t;
  using H = health_t;
  return {
      {"inertia + 10 %, from the push", 0, 0, 1.1, 0, 1.0, H::INERTIA, 0},
      {"inertia + 10 %, from a push 8 times as hard", 0, 0, 1.1, 0, 8.0, H::INERTIA, 0},
      {"disc friction doubled, from the start", 1, 0, 2.0, 0, 0.0, H::DISC_FRICTION, 0},
      {"gyro off by 0.05 rad/s", R::SENSOR_BIASED, S::VALID_GYRO, 0.05, 0, 0.0, H::SENSOR,
       H::DISAGREES},
      {"accelerometer off by 0.5 m/s^2", R::SENSOR_BIASED, S::VALID_ACCELEROMETER, 0.5, 0, 0.0,
       H::SENSOR + 1, H::DISAGREES},
      {"disc encoder stuck", R::SENSOR_STUCK, S::VALID_DISC, 0, 0, 0.0, H::SENSOR + 2, H::STUCK},
      {"gimbal encoders stuck", R::SENSOR_STUCK, S::VALID_GIMBALS, 0, 0, 0.0, H::SENSOR + 3,
       H::STUCK},
      {"gyro stuck", R::SENSOR_STUCK, S::VALID_GYRO, 0, 0, 0.0, H::SENSOR, H::STUCK},
      {"gimbal encoders off by 0.02 rad", R::SENSOR_BIASED, S::VALID_GIMBALS, 0.02, 0, 0.0,
       H::SENSOR + 3, H::DISAGREES},
      {"gimbal encoders noisy, 0.01 rad", R::SENSOR_NOISY, S::VALID_GIMBALS, 0.01, 0, 0.0,
       H::SENSOR + 3, H::DISAGREES},
      {"rotor 0 unpowered", R::ROTOR_LOSS, 0, 0, 0, 0.0, H::ROTOR, 0},
      {"rotor speeds off by 5 %", R::SENSOR_BIASED, S::VALID_ROTORS, -0.05, 0, 0.0, H::SENSOR + 4,
       H::DISAGREES},
      {"drive 0 at half its torque, from the push", R::DRIVE_WEAK, 0, 0.5, 0, 1.0, H::DRIVE, 0},
      {"gyro late by 30 ms, from the push", R::SENSOR_DELAYED, S::VALID_GYRO, 0, 0.03, 1.0,
       H::SENSOR, H::LATE},
      {"accelerometer late by 30 ms, from the push", R::SENSOR_DELAYED, S::VALID_ACCELEROMETER, 0,
       0.03, 1.0, H::SENSOR + 1, H::LATE},
      {"disc encoder late by 30 ms, from the push", R::SENSOR_DELAYED, S::VALID_DISC, 0, 0.03, 1.0,
       H::SENSOR + 2, H::LATE},
      {"gimbal encoders late by 30 ms, from the push", R::SENSOR_DELAYED, S::VALID_GIMBALS, 0, 0.03,
       1.0, H::SENSOR + 3, H::LATE},
      {"gyro silent", R::SENSOR_DROPPED, S::VALID_GYRO, 0, 0, 0.0, H::SENSOR, H::SILENT},
  };
}

/// The rig with a part that is not its model's; nothing where it has no such part.
std::optional<TwinBench::Overrides> wrong_part(const std::string& name, const Fault& fault) {
  const Rig rig = load_rig(name);
  const auto times = [&](const char* key, double value) {
    return std::string(key) + "=" + std::to_string(fault.level * value);
  };
  if (const auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    if (fault.kind == 0) {
      return {{times("structure.inertia_x_kgm2", p->structure.inertia_x),
               times("structure.inertia_y_kgm2", p->structure.inertia_y)}};
    }
    return {{times("disc.viscous_friction_nms_per_rad", p->disc.viscous_friction),
             times("disc.coulomb_friction_nm", p->disc.coulomb_friction)}};
  }
  const auto* p = std::get_if<model::GimballedParameters>(&rig.machine);
  if (p == nullptr || fault.kind != 0) return std::nullopt;
  return {{times("structure.inertia_tilt_kgm2", p->structure.inertia_tilt)}};
}

/// @return seconds until it is named; < 0: it is not; nothing where the rig cannot have it
std::optional<double> time_to_name(const std::string& name, const Fault& fault, int seed) {
  constexpr double kPatience = 8.0;
  const bool part =
      fault.detail == 0 && fault.blame != health_t::ROTOR && fault.blame != health_t::DRIVE;
  TwinBench::Overrides wrong;
  if (part) {
    const auto overrides = wrong_part(name, fault);
    if (!overrides) return std::nullopt;
    wrong = *overrides;
  }
  TwinBench bench(name, wrong, on_estimate(seed));
  bench.run(part ? 1.0 : 2.0);
  double level = fault.level;
  if (fault.target == sensors_t::VALID_ROTORS) level *= bench.machine.nominal_rotor_speed[0];
  if (!part && !bench.fault(fault.kind, fault.target, level, fault.delay_s)) return std::nullopt;
  double begin = bench.time();
  if (fault.push > 0.0) {
    bench.run(1.0);
    begin = bench.time();
    bench.push(fault.push);
  }
  const bool sensor = fault.blame >= health_t::SENSOR;
  const auto named = [&](const health_t& said) {
    if (said.verdict != health_t::DISAGREES || said.blame != fault.blame) return false;
    return sensor ? said.sensor_verdict[fault.blame - health_t::SENSOR] == fault.detail
                  : said.blamed_index == fault.detail;
  };
  if (named(bench.said)) return 0.0;
  return bench.run_until(named, kPatience) < 0.0 ? -1.0 : bench.time() - begin;
}

int print_faults(int runs) {
  std::printf("| wrong |");
  for (const std::string& rig : kRigs) std::printf(" `%s` |", rig.c_str());
  std::printf("\n|---|");
  for (std::size_t i = 0; i < kRigs.size(); ++i) std::printf("---|");
  std::printf("\n");
  for (const Fault& fault : faults()) {
    std::printf("| %s |", fault.what);
    for (const std::string& rig : kRigs) {
      double worst = 0.0;
      int named = 0, possible = 0;
      for (int seed = 1; seed <= runs; ++seed) {
        const std::optional<double> time = time_to_name(rig, fault, seed);
        if (!time) continue;
        ++possible;
        if (*time >= 0.0) ++named;
        worst = std::max(worst, *time);
      }
      if (possible == 0) {
        std::printf(" - |");
      } else if (named == possible) {
        std::printf(" %.2f s |", worst);
      } else {
        std::printf(" %d of %d |", named, possible);
      }
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return 0;
}

/// Quiet, or with the reference push every 20 s.
int count_changes(const std::string& name, double seconds, bool pushes) {
  TwinBench bench(name, {}, on_estimate(1));
  const auto end = std::llround(seconds * bench.rig.loop.rate_hz);
  const auto period = std::llround(20.0 * bench.rig.loop.rate_hz);
  int changes = 0, sensors = 0;
  health_t last{};
  for (std::int64_t k = 0; k < end; ++k) {
    if (pushes && k % period == period / 2) bench.push(k / period % 2 == 0 ? 0.4 : 1.0);
    if (!bench.step()) return 1;
    if (last.verdict != health_t::NONE) {
      if (bench.said.verdict != last.verdict) {
        ++changes;
        std::fprintf(stderr, "%s, %.3f s: %s\n", name.c_str(), bench.time(), bench.text().c_str());
      }
      for (int s = 0; s < kHealthSensors; ++s) {
        sensors += bench.said.sensor_verdict[s] != last.sensor_verdict[s];
      }
    }
    last = bench.said;
  }
  std::printf("| `%s` | %s | %.0f s | %d | %d |\n", name.c_str(), pushes ? "pushed" : "left alone",
              seconds, changes, sensors);
  std::fflush(stdout);
  return changes;
}

int print_alarms(double seconds) {
  std::printf(
      "| rig | | time | verdict changed | a sensor's verdict changed |\n|---|---|---|---|---|\n");
  int changes = 0;
  for (const std::string& rig : kRigs) {
    for (const bool pushes : {false, true}) changes += count_changes(rig, seconds, pushes);
  }
  return changes == 0 ? 0 : 1;
}

}  // namespace
}  // namespace gyrotwin

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  if (what == "times") return gyrotwin::print_times();
  if (what == "faults" && count > 2) return gyrotwin::print_faults(std::atoi(words[2]));
  if (what == "alarms" && count > 2) return gyrotwin::print_alarms(std::atof(words[2]));
  std::fprintf(stderr, "mirror_figures times | faults RUNS | alarms SECONDS\n");
  return 2;
}
