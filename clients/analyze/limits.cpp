#include "clients/analyze/limits.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "clients/common/event.hpp"
#include "clients/simulate/trial.hpp"

namespace gyrotwin {

namespace {

constexpr double kAccuracy = 0.02;  // between standing and falling, as a share
constexpr int kDoublings = 14;      // up or down from the first guess
constexpr int kGustSeeds = 3;       // a gust is stood when all of them are
constexpr double kSettled = 0.25;   // the largest tilt of the last fifth, of the largest of all

/// One kind of load, of any strength.
struct Load {
  std::string key, meaning, unit;
  std::string_view kind;      // of event_kinds()
  std::string_view quantity;  // which one is its strength
  double first_guess;
  bool random;
};

void set(AskedEvent& asked, std::string_view name, double value) {
  for (const Quantity& quantity : asked.kind->quantities) {
    if (quantity.name == name) asked.values.emplace_back(&quantity, value);
  }
}

/// When a load comes, and how long it is looked at from then on [s].
struct Span {
  double begin, duration;
};

request_t request_for(const Rig& rig, const Load& load, double begin, double strength, int seed) {
  AskedEvent asked;
  asked.kind = event_kind(load.kind);
  set(asked, load.quantity, strength);
  if (load.random) set(asked, "seed", seed);
  request_t request = request_of(asked, rig, rig.loop.tick_ns());
  request.start_tick = std::max(std::llround(begin / rig.loop.tick_s()), 1LL);
  return request;
}

/// Whether it stands the load, and how far it tilts.
struct Attempt {
  bool stands;
  double largest_tilt;
};

Attempt attempt(const Rig& rig, const model::Machine& machine, const Load& load, double strength,
                const Span& span) {
  Attempt worst{true, 0.0};
  for (int seed = 1; seed <= (load.random ? kGustSeeds : 1); ++seed) {
    Scenario scenario = live_scenario(rig, machine, span.begin + span.duration);
    scenario.events = {{request_for(rig, load, span.begin, strength, seed), load.key}};
    const Trial trial = run_trial(rig, machine, scenario);
    worst.largest_tilt = std::max(worst.largest_tilt, trial.largest_tilt);
    const bool calm = !trial.outcome.verdict.growing() ||
                      trial.largest_tilt < kSettled * rig.safety.fall_tilt_rad;
    worst.stands = trial.stood() && calm;
    if (!worst.stands) return worst;
  }
  return worst;
}

Limit limit_of(const Rig& rig, const model::Machine& machine, const Load& load, const Span& span) {
  Limit limit{load.key, load.meaning, load.unit, 0.0, std::numeric_limits<double>::infinity(),
              0.0,      span.duration};
  const auto tries = [&](double strength) {
    const Attempt made = attempt(rig, machine, load, strength, span);
    if (made.stands) {
      limit.stands = strength;
      limit.largest_tilt = made.largest_tilt;
    } else {
      limit.falls = strength;
    }
    return made.stands;
  };
  const bool up = tries(load.first_guess);
  for (int i = 0; i < kDoublings; ++i) {
    const double next = up ? 2.0 * limit.stands : 0.5 * limit.falls;
    if (tries(next) != up) break;
  }
  if (limit.stands == 0.0 || std::isinf(limit.falls)) return limit;
  while (limit.falls > (1.0 + kAccuracy) * limit.stands) tries(0.5 * (limit.stands + limit.falls));
  return limit;
}

std::vector<Load> loads_of(const Rig& rig, const model::Machine& machine) {
  const double push = rig.reference_impulse_nms;
  // The reference push as a moment that lasts about as long as a platform takes to answer.
  const double moment = push / 0.5;
  std::vector<Load> loads;
  for (const auto& [axis, word] :
       {std::pair{0, std::string("roll")}, std::pair{1, std::string("pitch")}}) {
    if (machine.layout.tilt[static_cast<std::size_t>(axis)] == model::kFixed) continue;
    const std::string about = std::string(axis == 0 ? "about x" : "about y") + " (" + word + ")";
    const std::string_view quantity = axis == 0 ? "roll" : "pitch";
    loads.push_back({"impulse_" + word,
                     fmt::format("impulse {}, within {:g} s", about, rig.impulse_duration_s),
                     "N m s", "impulse", quantity, push, false});
    loads.push_back(
        {"moment_" + word, "constant moment " + about, "N m", "step", quantity, moment, false});
    loads.push_back({"gust_" + word, "gust " + about + ", root mean square, correlation time 1 s",
                     "N m", "gust", quantity, moment, true});
  }
  return loads;
}

}  // namespace

std::vector<Limit> limits_of(const Rig& rig, double begin, double duration, int threads) {
  const model::Machine machine = rig.build_machine();
  const std::vector<Load> loads = loads_of(rig, machine);
  std::vector<Limit> limits(loads.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < loads.size(); i = next++) {
      limits[i] = limit_of(rig, machine, loads[i], {begin, duration});
    }
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  others.clear();
  return limits;
}

}  // namespace gyrotwin
