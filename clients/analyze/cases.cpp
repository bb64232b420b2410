#include "clients/analyze/cases.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "clients/analyze/loads.hpp"
#include "clients/common/tilt.hpp"
#include "clients/common/time_text.hpp"

namespace gyrotwin {

namespace {

constexpr double kAtRest = 3.0;   // a deviation has died out after so many e-foldings
constexpr double kSoonest = 0.1;  // a push comes [s]
constexpr double kLatest = 10.0;  // [s]
constexpr double kSurely = 3.0;   // e-foldings that a growing run would have shown
constexpr double kLongest = 5.0;  // a run is drawn out at most to so many durations
constexpr double kStayed = 0.5;   // a tilt at the end of that share of the largest stayed

Trial undisturbed_run(const Rig& rig, const model::Machine& machine, double duration) {
  return run_trial(rig, machine, live_scenario(rig, machine, duration));
}

/// What is still moving when it is pushed may decide the outcome: the push waits for it.
double push_time(const Case& seen) {
  const double decay = -growth_of(seen).value_or(0.0);
  return decay > kNoGrowth ? std::clamp(kAtRest / decay, kSoonest, kLatest) : kSoonest;
}

/// When a slowly growing tilt passes the fall limit [s].
double fall_expected(const Rig& rig, const Trial& trial, double growth) {
  const double now = std::max(trial.end_tilt, 1e-6);
  return trial.outcome.t + std::log(rig.safety.fall_tilt_rad / now) / growth;
}

std::string how_it_ended(const Trial& trial) {
  return fmt::format("tilt at most {:.3g} deg, {:.3g} deg after {:.3g} s",
                     degrees(trial.largest_tilt), degrees(trial.end_tilt), trial.outcome.t);
}

void judge_without_tilt(Case& seen) {
  const Trial& trial = seen.undisturbed;
  const bool pushed_off = seen.pushed && !seen.pushed->stood();
  if (!trial.stood()) {
    seen.standing = Standing::kFalls;
    seen.sentence = fmt::format("falls: a gimbal meets its stop after {:.3g} s",
                                trial.outcome.verdict.fell_at().value_or(trial.outcome.t));
    return;
  }
  const bool sinks = trial.outcome.verdict.growing();
  seen.standing = pushed_off || sinks ? Standing::kDoubtful : Standing::kStands;
  seen.sentence =
      fmt::format("{}: {:.3g} deg from a stop at the closest{}", sinks ? "stands so far" : "stands",
                  degrees(trial.least_gimbal_margin), sinks ? ", and still closing in" : "");
}

/// Why one that stands undisturbed does not with its reference push; empty: it does.
std::string pushed_off(const Rig& rig, const Case& seen) {
  if (!seen.pushed) return "";
  const Verdict& verdict = seen.pushed->outcome.verdict;
  const std::string push =
      fmt::format("its reference push of {:g} N m s", rig.reference_impulse_nms);
  switch (fate_of(*seen.pushed, growth_of(seen))) {
    case Fate::kStands:
      return "";
    case Fate::kGrows:
      return fmt::format("its tilt still grows {:.3g} s after {}",
                         seen.pushed->outcome.t - seen.push_at, push);
    case Fate::kLeans:
      return verdict.leaning_text() + " after " + push;
    case Fate::kFalls:
      return fmt::format("falls {:.3g} s after {}",
                         verdict.fell_at().value_or(seen.pushed->outcome.t) - seen.push_at, push);
  }
  return "";
}

}  // namespace

std::optional<double> growth_of(const Case& seen) {
  return seen.linear ? seen.linear->growth() : std::nullopt;
}

Fate fate_of(const Trial& trial, std::optional<double> growth) {
  const Verdict& verdict = trial.outcome.verdict;
  if (!trial.stood()) return Fate::kFalls;
  if (verdict.leans()) return Fate::kLeans;
  const bool dies_out = growth && *growth < -kNoGrowth;
  return verdict.growing() && !dies_out ? Fate::kGrows : Fate::kStands;
}

void judge(const Rig& rig, Case& seen) {
  const Trial& trial = seen.undisturbed;
  if (!trial.outcome.verdict.has_tilt()) return judge_without_tilt(seen);
  const std::optional<double> growth = growth_of(seen);
  const Fate fate = fate_of(trial, growth);
  if (fate == Fate::kFalls) {
    seen.standing = Standing::kFalls;
    seen.sentence = fmt::format("falls after {:.3g} s",
                                trial.outcome.verdict.fell_at().value_or(trial.outcome.t));
    return;
  }
  if (fate == Fate::kLeans) {
    seen.standing = Standing::kLeans;
    seen.sentence = trial.outcome.verdict.leaning_text() + ": " + how_it_ended(trial);
    return;
  }
  const bool grows = growth && *growth > kNoGrowth;
  if (fate == Fate::kGrows || (grows && *growth * trial.outcome.t < kSurely)) {
    seen.standing = Standing::kDoubtful;
    seen.sentence = "stands so far: " + how_it_ended(trial) + ", and growing";
    if (grows) {
      seen.sentence += fmt::format(" by {:.3g} 1/s: it doubles in {} and falls after about {}",
                                   *growth, time_text(std::numbers::ln2 / *growth),
                                   time_text(fall_expected(rig, trial, *growth)));
    }
    return;
  }
  if (const std::string off = pushed_off(rig, seen); !off.empty()) {
    seen.standing = Standing::kDoubtful;
    seen.sentence = "stands, but " + off;
    return;
  }
  const bool stayed = trial.end_tilt > kStayed * trial.largest_tilt;
  const bool returns = growth && *growth < -kNoGrowth;
  seen.standing = stayed && !returns ? Standing::kNeutral : Standing::kStands;
  seen.sentence =
      (seen.standing == Standing::kNeutral ? "stays up without coming back: " : "stands: ") +
      how_it_ended(trial);
  if (grows) {
    seen.sentence += "; upright itself is unstable, it keeps moving about it";
  }
}

std::string word_for(Standing standing) {
  switch (standing) {
    case Standing::kStands:
      return "stands";
    case Standing::kNeutral:
      return "neutral";
    case Standing::kDoubtful:
      return "doubtful";
    case Standing::kLeans:
      return "leans";
    case Standing::kFalls:
      return "falls";
  }
  return "";
}

Case run_case(const Rig& rig, std::string key, std::string name, double duration) {
  const model::Machine machine = rig.build_machine();
  Case seen;
  seen.key = std::move(key);
  seen.name = std::move(name);
  seen.linear = linear_model(rig);
  seen.push_at = push_time(seen);
  seen.undisturbed = undisturbed_run(rig, machine, duration);
  const std::optional<double> growth = growth_of(seen);
  if (seen.undisturbed.stood() && growth && *growth > kNoGrowth) {
    const double expected = 1.2 * fall_expected(rig, seen.undisturbed, *growth);
    if (expected > duration && expected < kLongest * duration) {
      seen.undisturbed = undisturbed_run(rig, machine, expected);
    }
  }
  if (seen.undisturbed.stood() && rig.reference_impulse_nms > 0.0) {
    seen.pushed = run_trial(
        rig, machine, push_scenario(rig, machine, seen.push_at, seen.push_at + duration / 3.0));
  }
  judge(rig, seen);
  return seen;
}

Rig left_alone(Rig rig) {
  rig.controller.law = LawKind::kNone;
  return rig;
}

}  // namespace gyrotwin
