#include "clients/analyze/limits.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "clients/analyze/loads.hpp"
#include "clients/common/parallel.hpp"

namespace gyrotwin {

namespace {

constexpr double kAccuracy = 0.02;  // between standing and falling, as a share
constexpr int kDoublings = 14;      // up or down from the first guess
constexpr int kGustSeeds = 3;       // a gust is stood when all of them are

/// One kind of load, of any strength.
struct Load {
  std::string key, meaning, unit;
  std::string_view kind;      // of event_kinds()
  std::string_view quantity;  // which one is its strength
  double first_guess;
  bool random;
};

/// When a load comes, and how long it is looked at from then on [s].
struct Span {
  double begin, duration;
};

void set(AskedEvent& asked, std::string_view name, double value) {
  for (const Quantity& quantity : asked.kind->quantities) {
    if (quantity.name == name) asked.values.emplace_back(&quantity, value);
  }
}

Attempt attempt(const Rig& rig, const model::Machine& machine, const Load& load, double strength,
                const Span& span) {
  Attempt worst{Fate::kStands, 0.0};
  for (int seed = 1; seed <= (load.random ? kGustSeeds : 1); ++seed) {
    AskedEvent asked;
    asked.kind = event_kind(load.kind);
    set(asked, load.quantity, strength);
    if (load.random) set(asked, "seed", seed);
    Scenario scenario = live_scenario(rig, machine, span.begin + span.duration);
    scenario.events = {event_at(rig, asked, span.begin, load.key)};
    const Trial trial = run_trial(rig, machine, scenario);
    worst.largest_tilt = std::max(worst.largest_tilt, trial.largest_tilt);
    worst.fate = fate_of(trial, std::nullopt);
    const bool far = trial.largest_tilt >= kGrowingFalls * rig.safety.fall_tilt_rad;
    if (worst.fate == Fate::kGrows && !far) worst.fate = Fate::kStands;
    if (worst.fate != Fate::kStands) return worst;
  }
  return worst;
}

std::vector<Load> loads_of(const Rig& rig, const model::Machine& machine) {
  const double push = rig.reference_impulse_nms > 0.0 ? rig.reference_impulse_nms : 1.0;
  // The push as a moment that lasts about as long as a platform takes to answer.
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

Bracket bracket_of(const std::function<Attempt(double strength)>& attempt, double first_guess) {
  Bracket bracket{.ends = std::numeric_limits<double>::infinity()};
  const auto tries = [&](double strength) {
    const Attempt made = attempt(strength);
    const bool stands = made.fate == Fate::kStands;
    if (stands) {
      bracket.stands = strength;
      bracket.largest_tilt = made.largest_tilt;
    } else {
      bracket.ends = strength;
      bracket.how = made.fate;
    }
    return stands;
  };
  const bool up = tries(first_guess);
  for (int i = 0; i < kDoublings; ++i) {
    const double next = up ? 2.0 * bracket.stands : 0.5 * bracket.ends;
    if (tries(next) != up) break;
  }
  if (bracket.stands == 0.0 || std::isinf(bracket.ends)) return bracket;
  while (bracket.ends > (1.0 + kAccuracy) * bracket.stands) {
    tries(0.5 * (bracket.stands + bracket.ends));
  }
  return bracket;
}

std::vector<Limit> limits_of(const Rig& rig, double begin, double duration, int threads) {
  const model::Machine machine = rig.build_machine();
  const std::vector<Load> loads = loads_of(rig, machine);
  std::vector<Limit> limits(loads.size());
  for_each_index(loads.size(), threads, [&](std::size_t i) {
    const Load& load = loads[i];
    const auto with = [&](double strength) {
      return attempt(rig, machine, load, strength, {begin, duration});
    };
    limits[i] = {load.key, load.meaning, load.unit, bracket_of(with, load.first_guess), duration};
  });
  return limits;
}

}  // namespace gyrotwin
