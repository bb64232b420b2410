#include "clients/analyze/analysis.hpp"

#include <spdlog/fmt/fmt.h>

#include <functional>

#include "clients/analyze/reasons.hpp"
#include "clients/common/mount.hpp"
#include "clients/common/parallel.hpp"

namespace gyrotwin {

namespace {

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
  if (held_level(rig)) {
    cases.push_back([=] {
      return run_case(with_mount(rig, model::Mount::kUniversalJoint), "disc_free",
                      law_words(rig) + ", its disc free on a universal joint", duration);
    });
  }
  return cases;
}

std::string caution_for(const Rig& rig, const Analysis& analysis) {
  if (!held_level(rig)) return "";
  const Case& filed = analysis.as_filed();
  const Trial& trial = filed.pushed ? *filed.pushed : filed.undisturbed;
  const Case& free = analysis.cases.back();
  return fmt::format("{} with up to {:.3g} N m{}. With nothing outside it {}{}.", kHeldLevel,
                     trial.largest_holding_moment, filed.pushed ? " while it was pushed" : "",
                     free.sentence, filed.pushed && !free.pushed ? ", even without a push" : "");
}

}  // namespace

Analysis analyse(const Rig& rig, double duration, int threads) {
  Analysis analysis;
  analysis.duration = duration;
  analysis.fall_tilt = rig.safety.fall_tilt_rad;
  const std::vector<std::function<Case()>> runs = cases_for(rig, duration);
  analysis.cases.resize(runs.size());
  for_each_index(runs.size(), threads, [&](std::size_t i) { analysis.cases[i] = runs[i](); });

  const Case& filed = analysis.as_filed();
  analysis.theory = theory_of(rig, filed.linear);
  analysis.reason = reason_for(rig, filed, analysis.theory);
  analysis.caution = caution_for(rig, analysis);
  analysis.comparisons = compare_solutions(rig);
  const bool up = filed.standing != Standing::kFalls && filed.standing != Standing::kLeans;
  if (up && filed.undisturbed.outcome.verdict.has_tilt()) {
    analysis.limits = limits_of(rig, filed.push_at, duration / 3.0, threads);
  }
  return analysis;
}

}  // namespace gyrotwin
