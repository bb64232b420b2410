#include "clients/analyze/analysis.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <variant>

#include "clients/common/mount.hpp"

namespace gyrotwin {

namespace {

const model::UmbrellaParameters* umbrella_of(const Rig& rig) {
  return std::get_if<model::UmbrellaParameters>(&rig.machine);
}

std::string law_words(const Rig& rig) {
  return rig.controller.law == LawKind::kNone
             ? "without a law"
             : "under its law " + std::string(name_of(rig.controller.law));
}

std::vector<std::function<Case()>> cases_for(const Rig& rig, double duration) {
  std::vector<std::function<Case()>> cases;
  cases.push_back([=] { return run_case(rig, "as_filed", law_words(rig), duration); });
  if (rig.controller.law != LawKind::kNone) {
    cases.push_back(
        [=] { return run_case(left_alone(rig), "left_alone", "drives left alone", duration); });
  }
  const auto* umbrella = umbrella_of(rig);
  if (umbrella != nullptr && umbrella->mount == model::Mount::kLevel) {
    cases.push_back([=] {
      return run_case(with_mount(rig, model::Mount::kUniversalJoint), "disc_free",
                      law_words(rig) + ", its disc free on a universal joint", duration);
    });
  }
  return cases;
}

/// "with its disc free": how the reason begins.
std::string situation(const Rig& rig) {
  if (const auto* umbrella = umbrella_of(rig)) {
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
  const std::string unit = condition.unit.empty() ? "" : " " + condition.unit;
  return fmt::format("{} ({:.3g} against {:.3g}{}): {}", condition.claim, condition.value,
                     condition.required, unit, condition.meaning);
}

const Condition* first_broken(const Theory& theory, bool decides) {
  const auto& all = theory.conditions;
  const auto found = std::ranges::find_if(
      all, [=](const Condition& c) { return !c.holds && c.decides == decides; });
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

std::string why_it_falls(const Rig& rig, const Case& seen, const Theory& theory) {
  std::string where = situation(rig) + ", and ";
  if (rig.load_cell) where = "the load cell holds it along one direction alone; " + where;
  if (const Condition* broken = first_broken(theory, true)) {
    return where + "this does not hold: " + told(*broken);
  }
  const bool grows = seen.linear && seen.linear->modes.growth > 0.0;
  if (grows) {
    const std::string rate =
        fmt::format("{}small deviations grow by {:.3g} 1/s", where, seen.linear->modes.growth);
    const Condition* advice = first_broken(theory, false);
    return advice == nullptr ? rate : rate + "; this does not hold: " + told(*advice);
  }
  const Trial& trial = seen.undisturbed.stood() && seen.pushed ? *seen.pushed : seen.undisturbed;
  if (trial.least_gimbal_margin < 0.0) {
    return where + "the gimbals met their stops: from there on they turn no momentum";
  }
  return where + "no linear condition forbids it to stand: it is taken too far from upright";
}

std::string why_it_stands(const Rig& rig, const Case& seen, const Theory& theory) {
  std::string text = situation(rig);
  if (rig.load_cell) text += ", its load cell holds the structure";
  if (seen.linear && seen.linear->modes.growth < 0.0) {
    text += fmt::format(", small deviations die out by {:.3g} 1/s", -seen.linear->modes.growth);
  }
  if (first_broken(theory, true) != nullptr) return text;
  if (const Condition* least = weakest(theory)) {
    text += fmt::format("; nothing that it hangs on fails, closest is {} with a factor {:.3g}",
                        least->claim, least->margin);
  }
  return text;
}

std::string caution_for(const Rig& rig, const Analysis& analysis) {
  const auto* umbrella = umbrella_of(rig);
  if (umbrella == nullptr || umbrella->mount != model::Mount::kLevel) return "";
  const Case& filed = analysis.as_filed();
  const Trial& trial = filed.pushed ? *filed.pushed : filed.undisturbed;
  return fmt::format(
      "mount `level` is an idealisation: something outside held the disc level with up to {:.3g} "
      "N m{}. With nothing outside it {}.",
      trial.largest_holding_moment, filed.pushed ? " while it was pushed" : "",
      analysis.cases.back().sentence);
}

}  // namespace

Analysis analyse(const Rig& rig, double duration, int threads) {
  Analysis analysis;
  analysis.duration = duration;
  const auto policy = threads > 1 ? std::launch::async : std::launch::deferred;
  std::vector<std::future<Case>> running;
  for (const auto& run : cases_for(rig, duration)) running.push_back(std::async(policy, run));
  for (auto& run : running) analysis.cases.push_back(run.get());

  const Case& filed = analysis.as_filed();
  analysis.theory = theory_of(rig, filed.linear);
  const bool falls = filed.standing == Standing::kFalls || filed.standing == Standing::kDoubtful;
  analysis.reason = falls ? why_it_falls(rig, filed, analysis.theory)
                          : why_it_stands(rig, filed, analysis.theory);
  analysis.caution = caution_for(rig, analysis);
  analysis.comparisons = compare_solutions(rig);
  if (filed.standing != Standing::kFalls && filed.undisturbed.outcome.verdict.has_tilt()) {
    analysis.limits = limits_of(rig, filed.push_at, duration / 3.0, threads);
  }
  return analysis;
}

}  // namespace gyrotwin
