#include "clients/analyze/words.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "clients/common/tilt.hpp"
#include "clients/common/wrap.hpp"

namespace gyrotwin {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kColumns = 100, kMeaningAt = 63;

std::string heading(const std::string& text) { return "\n" + text + "\n"; }

std::string mark(const Condition& condition) {
  return condition.holds ? "ok" : condition.decides() ? "FAILS" : "fails";
}

std::string factor(double margin) {
  return std::isfinite(margin) ? fmt::format("x{:.3g}", margin) : "";
}

std::string told(const Case& seen) {
  std::string text = paragraph(seen.name, kColumns, 2) + paragraph(seen.sentence, kColumns, 4, 2);
  if (seen.pushed) text += paragraph("with its reference push " + push_words(seen), kColumns, 4, 2);
  if (!seen.linear) return text + paragraph("no steady motion to linearise about", kColumns, 4);
  const Modes& modes = seen.linear->modes;
  text += paragraph("eigenvalues [1/s]: " + listed_rates(modes.eigenvalues), kColumns, 4, 2);
  for (const std::string& caution : cautions(*seen.linear)) {
    text += paragraph('(' + caution + ')', kColumns, 4, 1);
  }
  return text;
}

std::string conditions_text(const Theory& theory) {
  std::string text = heading(
      "Conditions (FAILS decides: it does not come back upright; fails explains or advises)");
  for (const Condition& c : theory.conditions) {
    text += fmt::format("  {:<6}{:<44}", mark(c), c.claim);
    text += c.compares() ? fmt::format("{:>12.4g} {} {:<12.4g}{:<12}{}\n", c.value, c.relation,
                                       c.required, c.unit, factor(c.margin))
                         : fmt::format("{:>12}\n", c.holds ? "yes" : "no");
    text += paragraph(c.meaning, kColumns, 8);
  }
  return text;
}

std::string numbers_text(const Theory& theory) {
  std::string text = heading("Derived numbers");
  for (const DerivedNumber& n : theory.numbers) {
    std::string row = paragraph(n.meaning, kColumns, kMeaningAt);
    text += row.replace(0, kMeaningAt,
                        fmt::format("  {:<36}{:>12.5g} {:<12}", n.symbol, n.value, n.unit));
  }
  return text;
}

std::string criteria_text(const Theory& theory) {
  std::string text;
  if (!theory.criteria.empty()) text += heading("Characteristic polynomials of the reduced model");
  for (const Criterion& c : theory.criteria) {
    text += paragraph(c.name + ": " + c.formula, kColumns, 2, 2);
    text += paragraph("= " + text_of(c.polynomial), kColumns, 4, 2) + "    Routh's first column:";
    for (const auto& row : c.scheme.rows) text += fmt::format(" {:.4g}", row[0]);
    text += c.scheme.stable()        ? ": stable\n"
            : c.scheme.unstable == 0 ? ": roots on the imaginary axis\n"
                                     : fmt::format(": {} root{} to the right\n", c.scheme.unstable,
                                                   c.scheme.unstable == 1 ? "" : "s");
  }
  return text;
}

std::string comparisons_text(const std::vector<Comparison>& comparisons) {
  std::string text;
  if (!comparisons.empty()) text += heading("Closed forms beside integration");
  for (const Comparison& c : comparisons) {
    text += paragraph(c.meaning, kColumns, 2, 2) +
            fmt::format("      {:>11.5g} and {:>11.5g} {:<6} off by {:.1e}\n", c.formula,
                        c.integrated, c.unit, c.deviation);
  }
  return text;
}

std::string limits_text(const Analysis& analysis) {
  if (analysis.limits.empty()) return "";
  std::string text = heading("Limits, by bisection on the full model");
  text += paragraph('(' + limits_rule(analysis) + ')', kColumns, 2, 1);
  for (const Limit& limit : analysis.limits) {
    text += fmt::format("  {}\n      stands {:<14} {:<36} tilt up to {:.3g} deg\n", limit.meaning,
                        with_unit(limit.bracket.stands, limit.unit) + ",", limit_words(limit) + ",",
                        degrees(limit.bracket.largest_tilt));
  }
  return text;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json trial_json(const Trial& trial) {
  const auto fell = trial.outcome.verdict.fell_at();
  return {{"stood", trial.stood()},
          {"duration_s", trial.outcome.t},
          {"leans", trial.outcome.verdict.leans()},
          {"fell_at_s", fell ? Json(*fell) : Json(nullptr)},
          {"largest_tilt_rad", number(trial.largest_tilt)},
          {"end_tilt_rad", number(trial.end_tilt)},
          {"least_gimbal_margin_rad", number(trial.least_gimbal_margin)},
          {"largest_torque_nm", number(trial.largest_torque)},
          {"drive_at_limit_share", number(trial.at_limit)},
          {"first_rotor_share", number(trial.first_rotor_share)},
          {"largest_holding_moment_nm", number(trial.largest_holding_moment)}};
}

Json linear_json(const LinearModel& linear) {
  Json eigenvalues = Json::array();
  for (const std::complex<double>& x : linear.modes.eigenvalues) {
    eigenvalues.push_back({x.real(), x.imag()});
  }
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < linear.modes.F.rows(); ++i) {
    const Eigen::RowVectorXd row = linear.modes.F.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  const auto& modes = linear.modes;
  return {{"growth_per_s", modes.growth},
          {"eigenvalues_per_s", eigenvalues},
          {"polynomial", polynomial_of(modes.eigenvalues)},
          {"states", modes.states},
          {"matrix", rows},
          {"jacobian_against_differences", modes.difference},
          {"law_bends", modes.law_bends},
          {"machine_bends", modes.plant_bends},
          {"estimated", linear.estimated},
          {"coasts", linear.steady.coasts}};
}

Json case_json(const Case& seen) {
  return {{"key", seen.key},
          {"name", seen.name},
          {"standing", word_for(seen.standing)},
          {"sentence", seen.sentence},
          {"undisturbed", trial_json(seen.undisturbed)},
          {"push_at_s", seen.push_at},
          {"pushed", seen.pushed ? trial_json(*seen.pushed) : Json(nullptr)},
          {"linear", seen.linear ? linear_json(*seen.linear) : Json(nullptr)}};
}

Json theory_json(const Theory& theory) {
  Json numbers = Json::array(), conditions = Json::array(), criteria = Json::array();
  for (const DerivedNumber& n : theory.numbers) {
    numbers.push_back({{"key", n.key},
                       {"symbol", n.symbol},
                       {"meaning", n.meaning},
                       {"value", number(n.value)},
                       {"unit", n.unit}});
  }
  for (const Condition& c : theory.conditions) {
    conditions.push_back({{"key", c.key},
                          {"claim", c.claim},
                          {"meaning", c.meaning},
                          {"value", number(c.value)},
                          {"relation", c.relation},
                          {"required", number(c.required)},
                          {"unit", c.unit},
                          {"holds", c.holds},
                          {"decides", c.decides()},
                          {"explains", c.role == Role::kExplains},
                          {"margin", number(c.margin)}});
  }
  for (const Criterion& c : theory.criteria) {
    criteria.push_back({{"name", c.name},
                        {"formula", c.formula},
                        {"polynomial", c.polynomial},
                        {"routh", c.scheme.rows},
                        {"unstable_roots", c.scheme.unstable},
                        {"opposite_roots", c.scheme.opposite_roots}});
  }
  return {{"numbers", numbers}, {"conditions", conditions}, {"criteria", criteria}};
}

}  // namespace

std::string limits_rule(const Analysis& analysis) {
  return fmt::format(
      "each load is looked at for {:.3g} s. It is stood when the machine has not fallen by then, "
      "does "
      "not hang in its gimbals' stops and, beyond {:.3g} deg, no longer tilts further; under a "
      "gust, "
      "whose largest swing comes by chance, falls and stops alone count, with three seeds",
      analysis.limits.front().duration, degrees(kGrowingFalls * analysis.fall_tilt));
}

std::string limit_words(const Limit& limit) {
  if (!std::isfinite(limit.bracket.ends)) return "no end found";
  const std::string at = with_unit(limit.bracket.ends, limit.unit);
  switch (limit.bracket.how) {
    case Fate::kLeans:
      return "its stops take over at " + at;
    case Fate::kGrows:
      return "still grows at " + at;
    case Fate::kFalls:
    case Fate::kStands:
      break;
  }
  return "falls at " + at;
}

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::vector<std::string> cautions(const LinearModel& linear) {
  std::vector<std::string> all;
  const Modes& modes = linear.modes;
  if (modes.law_bends) all.push_back("the law bends at upright; these are of its mean slope");
  if (modes.plant_bends) {
    all.push_back(
        "the machine bends there, an axle or a gimbal just touching; these are of one side");
  } else if (!modes.sound() && !modes.law_bends) {
    all.push_back(
        fmt::format("the exact Jacobian is off by {:.1e} against differences: these are "
                    "not to be trusted",
                    modes.difference));
  }
  if (linear.estimated) all.push_back("as if STATE were the truth; its estimator is not in them");
  if (linear.steady.coasts) all.push_back("at the disc's initial speed, which friction takes");
  return all;
}

std::string push_words(const Case& seen) {
  if (!seen.pushed) return "";
  const Outcome& outcome = seen.pushed->outcome;
  const double later = outcome.verdict.fell_at().value_or(outcome.t) - seen.push_at;
  std::string text = fmt::format("at {:.3g} s: {:.3g} s later it ", seen.push_at, later);
  switch (fate_of(*seen.pushed, growth_of(seen))) {
    case Fate::kStands:
      text += "stands";
      break;
    case Fate::kGrows:
      text += "still stands, and its motion grows";
      break;
    case Fate::kLeans:
      text += outcome.verdict.leaning_text();
      break;
    case Fate::kFalls:
      text += "falls";
      break;
  }
  if (outcome.verdict.has_tilt()) {
    text += fmt::format(", tilt at most {:.3g} deg", degrees(seen.pushed->largest_tilt));
  }
  return text;
}

std::string listed_rates(const Eigen::VectorXcd& eigenvalues) {
  std::string text;
  for (const std::complex<double>& rate : eigenvalues) {
    if (rate.imag() < 0.0) continue;  // the upper of the pair has said it
    text += (text.empty() ? "" : ", ") + fmt::format("{:.4g}", rate.real());
    if (rate.imag() > 0.0) text += fmt::format("+-{:.4g}i", rate.imag());
  }
  return text;
}

std::string text_of(const Rig& rig, const Analysis& analysis) {
  const Case& filed = analysis.as_filed();
  std::string text = paragraph(rig.name + ": " + filed.sentence, kColumns, 0, 2);
  text += paragraph("why: " + analysis.reason, kColumns, 2, 5);
  if (!analysis.caution.empty()) text += paragraph("but: " + analysis.caution, kColumns, 2, 5);
  text += heading("Simulated, and linearised about the steady motion");
  for (const Case& seen : analysis.cases) text += told(seen);
  return text + conditions_text(analysis.theory) + limits_text(analysis) +
         numbers_text(analysis.theory) + criteria_text(analysis.theory) +
         comparisons_text(analysis.comparisons);
}

Json json_of(const Rig& rig, const Analysis& analysis) {
  const Case& filed = analysis.as_filed();
  Json cases = Json::array(), comparisons = Json::array(), limits = Json::array();
  for (const Case& seen : analysis.cases) cases.push_back(case_json(seen));
  for (const Comparison& c : analysis.comparisons) {
    comparisons.push_back({{"key", c.key},
                           {"meaning", c.meaning},
                           {"formula", number(c.formula)},
                           {"integrated", number(c.integrated)},
                           {"deviation", number(c.deviation)},
                           {"unit", c.unit}});
  }
  for (const Limit& limit : analysis.limits) {
    limits.push_back({{"key", limit.key},
                      {"meaning", limit.meaning},
                      {"unit", limit.unit},
                      {"stands", number(limit.bracket.stands)},
                      {"ends", number(limit.bracket.ends)},
                      {"how", limit_words(limit)},
                      {"largest_tilt_rad", number(limit.bracket.largest_tilt)},
                      {"duration_s", limit.duration}});
  }
  return {{"rig", rig.name},
          {"standing", word_for(filed.standing)},
          {"sentence", filed.sentence},
          {"reason", analysis.reason},
          {"caution", analysis.caution},
          {"cases", cases},
          {"theory", theory_json(analysis.theory)},
          {"comparisons", comparisons},
          {"limits", limits}};
}

}  // namespace gyrotwin
