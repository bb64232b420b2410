#include "clients/analyze/reasons.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace gyrotwin {

namespace {

constexpr double kSlowRotors = 0.98;   // of their nominal speed
constexpr double kOftenAtLimit = 0.1;  // of a run

/// "with its disc free": how the reason begins.
std::string situation(const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    switch (umbrella->mount) {
      case model::Mount::kLevel:
        return "the disc is held level";
      case model::Mount::kUniversalJoint:
        return "the disc is free";
      case model::Mount::kRigid:
        return "the disc tilts with the structure";
    }
  }
  if (std::holds_alternative<model::GimballedParameters>(rig.machine)) {
    return rig.controller.law == LawKind::kNone ? "nothing drives the gimbals"
                                                : "the gimbals are driven";
  }
  return rig.controller.law == LawKind::kNone ? "nothing drives the post" : "the post is driven";
}

std::string told(const Condition& condition) {
  if (!condition.compares()) return condition.claim + ": " + condition.meaning;
  const std::string unit = condition.unit.empty() ? "" : " " + condition.unit;
  return fmt::format("{} ({:.3g} against {:.3g}{}): {}", condition.claim, condition.value,
                     condition.required, unit, condition.meaning);
}

const Condition* first_broken(const Theory& theory, Role role) {
  const auto& all = theory.conditions;
  const auto found =
      std::ranges::find_if(all, [=](const Condition& c) { return !c.holds && c.role == role; });
  return found == all.end() ? nullptr : &*found;
}

const Condition* weakest(const Theory& theory) {
  const Condition* least = nullptr;
  for (const Condition& condition : theory.conditions) {
    if (!condition.holds || !std::isfinite(condition.margin)) continue;
    if (least == nullptr || condition.margin < least->margin) least = &condition;
  }
  return least;
}

/// What the run itself tells, beside the conditions; empty: nothing.
std::string what_was_seen(const Trial& trial) {
  std::string text;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  if (trial.first_rotor_share < kSlowRotors) {
    add(fmt::format("its slowest rotor begins at {:.3g} % of its nominal speed",
                    100.0 * trial.first_rotor_share));
  }
  if (trial.at_limit > kOftenAtLimit) {
    add(fmt::format("a drive is at its limit for {:.0f} % of the run, {:.3g} N m at most",
                    100.0 * trial.at_limit, trial.largest_torque));
  }
  if (trial.least_gimbal_margin < 0.0) {
    add("the gimbals meet their stops: from there on they turn no momentum");
  }
  return text;
}

std::string why_it_falls(const Rig& rig, const Case& seen, const Theory& theory) {
  std::string where = situation(rig) + ", and ";
  if (rig.load_cell) where = "the load cell holds it along one direction alone; " + where;
  const Trial& trial = seen.undisturbed.stood() && seen.pushed ? *seen.pushed : seen.undisturbed;
  const std::string happened = what_was_seen(trial);
  const Condition* rule = first_broken(theory, Role::kExplains);
  const std::string because = (rule == nullptr ? "" : "; this rule is broken: " + told(*rule)) +
                              (happened.empty() ? "" : "; " + happened);
  if (const Condition* broken = first_broken(theory, Role::kDecides)) {
    return where + "this does not hold: " + told(*broken) + because;
  }
  const std::optional<double> growth = seen.linear ? seen.linear->growth() : std::nullopt;
  if (growth.value_or(0.0) > kNoGrowth) {
    return fmt::format("{}small deviations grow by {:.3g} 1/s", where, *growth) + because;
  }
  if (!happened.empty()) return where + happened;
  return where + "no linear condition forbids it to stand: it is taken too far from upright";
}

std::string why_it_stands(const Rig& rig, const Case& seen, const Theory& theory) {
  std::string text = situation(rig);
  if (rig.load_cell) text += ", its load cell holds the structure";
  const std::optional<double> growth = seen.linear ? seen.linear->growth() : std::nullopt;
  if (growth.value_or(0.0) < -kNoGrowth) {
    text += fmt::format(", small deviations die out at {:.3g} 1/s", -*growth);
  }
  if (const Condition* broken = first_broken(theory, Role::kDecides)) {
    return text + "; it does not come back upright, for this does not hold: " + told(*broken);
  }
  if (const Condition* least = weakest(theory)) {
    text += fmt::format("; nothing that it hangs on fails, closest is {} with a factor {:.3g}",
                        least->claim, least->margin);
  }
  return text;
}

}  // namespace

std::string reason_for(const Rig& rig, const Case& seen, const Theory& theory) {
  const bool falls = seen.standing != Standing::kStands && seen.standing != Standing::kNeutral;
  return falls ? why_it_falls(rig, seen, theory) : why_it_stands(rig, seen, theory);
}

}  // namespace gyrotwin
