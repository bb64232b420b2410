#include "clients/analyze/report.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "clients/analyze/words.hpp"
#include "clients/common/tilt.hpp"
#include "clients/plot/page.hpp"

namespace gyrotwin {

namespace {

using Rows = std::vector<std::vector<std::string>>;

Tone tone_of(Standing standing) {
  switch (standing) {
    case Standing::kStands:
      return Tone::kGood;
    case Standing::kNeutral:
    case Standing::kDoubtful:
      return Tone::kDoubtful;
    case Standing::kLeans:
    case Standing::kFalls:
      return Tone::kBad;
  }
  return Tone::kPlain;
}

std::string four(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : ""; }

void add_cases(const Analysis& analysis, Page& page) {
  Rows rows;
  std::vector<Tone> tones;
  for (const Case& seen : analysis.cases) {
    rows.push_back({word_for(seen.standing), seen.name, seen.sentence, push_words(seen),
                    seen.linear ? four(seen.linear->modes.growth) : ""});
    tones.push_back(tone_of(seen.standing));
  }
  page.table({"", "how it runs", "from its initial state", "with its reference push",
              "growth of small deviations [1/s]"},
             rows, tones);
}

void add_conditions(const Theory& theory, Page& page) {
  page.heading("What it hangs on");
  page.paragraph(
      "In red what decides: where it fails, the machine does not come back upright. The others "
      "explain or advise.");
  Rows rows;
  std::vector<Tone> tones;
  for (const Condition& c : theory.conditions) {
    rows.push_back({c.holds ? "holds" : "fails", c.claim, c.meaning,
                    c.compares() ? four(c.value) : "", c.relation, four(c.required), c.unit,
                    std::isfinite(c.margin) ? fmt::format("x {:.3g}", c.margin) : ""});
    tones.push_back(c.holds ? Tone::kGood : c.decides() ? Tone::kBad : Tone::kDoubtful);
  }
  page.table({"", "condition", "what it means", "left", "", "right", "unit", "margin"}, rows,
             tones);
}

void add_limits(const Analysis& analysis, Page& page) {
  if (analysis.limits.empty()) return;
  page.heading("What it takes");
  page.paragraph(
      "The strongest load of each kind that the full model stands under its law, by "
      "bisection: " +
      limits_rule(analysis) + ".");
  Rows rows;
  for (const Limit& limit : analysis.limits) {
    rows.push_back({limit.meaning, four(limit.bracket.stands), limit.unit, limit_words(limit),
                    fmt::format("{:.3g}", degrees(limit.bracket.largest_tilt))});
  }
  page.table({"load", "stands", "unit", "and then", "largest tilt [deg]"}, rows);
}

void add_numbers(const Theory& theory, Page& page) {
  page.heading("Derived numbers");
  Rows rows;
  for (const DerivedNumber& n : theory.numbers) {
    rows.push_back({n.symbol, four(n.value), n.unit, n.meaning});
  }
  page.table({"symbol", "value", "unit", "meaning"}, rows);
}

void add_eigenvalues(const Analysis& analysis, Page& page) {
  page.heading("Eigenvalues");
  page.paragraph(
      "Of the whole machine about its steady upright motion; under a law of the loop as it is "
      "sampled, ln(mu)/tick. The Jacobian is exact and was checked against differences.");
  Rows rows;
  for (const Case& seen : analysis.cases) {
    if (!seen.linear) {
      rows.push_back({seen.name, "no steady motion", "", "", ""});
      continue;
    }
    const Modes& modes = seen.linear->modes;
    rows.push_back({seen.name, listed_rates(modes.eigenvalues),
                    fmt::format("{}", fmt::join(cautions(*seen.linear), "; ")),
                    text_of(polynomial_of(modes.eigenvalues)),
                    fmt::format("{:.1e}", modes.difference)});
  }
  page.table(
      {"how it runs", "eigenvalues [1/s]", "but", "characteristic polynomial", "Jacobian off by"},
      rows);
}

void add_criteria(const Theory& theory, Page& page) {
  if (theory.criteria.empty()) return;
  page.heading("Routh's scheme of the reduced model");
  for (const Criterion& c : theory.criteria) {
    page.paragraph(c.name + ": " + c.formula + " = " + text_of(c.polynomial) + ". " +
                   (c.scheme.stable() ? "The first column keeps its sign: stable."
                    : c.scheme.unstable > 0
                        ? fmt::format("The first column changes its sign: {} root(s) to the right.",
                                      c.scheme.unstable)
                        : std::string("Roots on the imaginary axis.")));
    Rows rows;
    const auto degree = c.scheme.rows.size() - 1;
    for (std::size_t i = 0; i < c.scheme.rows.size(); ++i) {
      std::vector<std::string> row{fmt::format("s^{}", degree - i)};
      for (const double x : c.scheme.rows[i]) row.push_back(four(x));
      rows.push_back(row);
    }
    std::vector<std::string> header{"power"};
    header.resize(c.scheme.rows.front().size() + 1);
    page.table(header, rows);
  }
}

void add_comparisons(const Analysis& analysis, Page& page) {
  page.heading("Closed forms beside integration");
  Rows rows;
  for (const Comparison& c : analysis.comparisons) {
    rows.push_back({c.meaning, fmt::format("{:.6g}", c.formula),
                    fmt::format("{:.6g}", c.integrated), c.unit,
                    fmt::format("{:.1e}", c.deviation)});
  }
  page.table({"motion", "by formula", "integrated", "unit", "off by"}, rows);
}

}  // namespace

std::string report_html(const Rig& rig, const Analysis& analysis,
                        const std::vector<Figure>& figures) {
  const Case& filed = analysis.as_filed();
  Page page("Does " + rig.name + " stand?", rig.summary);
  page.verdict(tone_of(filed.standing), rig.name + " " + filed.sentence,
               "Why: " + analysis.reason + ".");
  if (!analysis.caution.empty()) page.verdict(Tone::kDoubtful, "But", analysis.caution);
  page.heading("How it fares");
  add_cases(analysis, page);
  add_conditions(analysis.theory, page);
  if (!figures.empty()) page.heading("How it moves");
  for (const Figure& figure : figures) page.figure(figure.svg, figure.caption);
  add_limits(analysis, page);
  add_numbers(analysis.theory, page);
  add_eigenvalues(analysis, page);
  add_criteria(analysis.theory, page);
  add_comparisons(analysis, page);
  page.heading("How this was made");
  page.paragraph(fmt::format(
      "gyrotwin analyze on {}. Runs take the very steps of the live system at {:g} Hz with {} "
      "steps "
      "a tick; undisturbed ones last {:g} s. Symbols and derivations: services/model/README.md, "
      "sections 4 and 5.",
      rig.name, rig.loop.rate_hz, rig.loop.substeps, analysis.duration));
  return page.html();
}

}  // namespace gyrotwin
