#include "clients/calibrate/findings.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace gyrotwin::calibration {

namespace {

std::string percent(double share) {
  return share < 100.0 ? fmt::format("{:.3g} %", 100.0 * share)
                       : std::string("more than 100 times it");
}

std::string refusal_of(double relative, const Knowledge& knowledge,
                       const std::vector<Parameter>& parameters) {
  if (relative <= kRefused) return {};
  const std::string sigma = std::isfinite(relative)
                                ? fmt::format("sigma is {} of its value", percent(relative))
                                : std::string("the data say nothing of it");
  if (knowledge.alone > kRefused || knowledge.entangled.empty()) {
    return sigma + ": what was measured hardly hangs on it";
  }
  std::string others;
  for (const std::size_t i : knowledge.entangled) {
    others += (others.empty() ? "" : ", ") + parameters[i].key;
  }
  return fmt::format("{}: it cannot be told from {} (if those were known: {})", sigma, others,
                     percent(knowledge.alone));
}

}  // namespace

std::vector<Finding> findings(const Family& family, const Fit& fit, const Identifiability& known) {
  std::vector<Finding> all;
  for (std::size_t i = 0; i < family.parameters().size(); ++i) {
    const Parameter& parameter = family.parameters()[i];
    const Knowledge& knowledge = known.of[i];
    Finding finding{.key = parameter.key,
                    .start = parameter.start,
                    .value = parameter.value(fit.x[i]),
                    .sigma = parameter.scale * knowledge.sigma,
                    .alone = knowledge.alone,
                    .refusal = {},
                    .advice = {}};
    finding.refusal = refusal_of(finding.relative(), knowledge, family.parameters());
    const ExperimentKind* best = finding.identified() ? nullptr : best_for(parameter.key);
    if (best != nullptr) {
      finding.advice = fmt::format("{} ({}) of {:.0f} s tells it: {}", best->name, best->does,
                                   watched_s(*best, family.rig_at(fit.x)), best->because);
    }
    all.push_back(std::move(finding));
  }
  return all;
}

}  // namespace gyrotwin::calibration
