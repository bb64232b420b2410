#include "clients/calibrate/report.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "clients/calibrate/rig_text.hpp"
#include "clients/plot/chart.hpp"
#include "clients/plot/page.hpp"

namespace gyrotwin::calibration {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kPointsDrawn = 1500;  // of one curve

double seconds_of(const Calibration& c) {
  double seconds = 0.0;
  for (const Stretch& stretch : c.stretches) seconds += stretch.seconds();
  return seconds;
}

std::string name_of_reading(int reading) {
  constexpr std::array<std::string_view, kReadings> kNames{
      "gyro x",  "gyro y",   "gyro z",   "accelerometer x", "accelerometer y", "accelerometer z",
      "disc",    "gimbal 0", "gimbal 1", "gimbal 2",        "gimbal 3",        "rotor 0",
      "rotor 1", "rotor 2",  "rotor 3",  "load cell"};
  return std::string(kNames[static_cast<std::size_t>(reading)]);
}

std::string value_text(const Finding& finding) {
  return finding.identified() ? number_with_sigma(finding.value, finding.sigma) : "-";
}

std::string sigma_text(const Finding& finding) {
  if (!std::isfinite(finding.sigma)) return "-";
  return fmt::format("{:.2g} ({:.2g} %)", finding.sigma, 100.0 * finding.relative());
}

/// "agreement: chi^2 1.02 a degree of freedom ...".
std::string agreement_text(const Calibration& c) {
  const double reduced = c.fit.reduced_chi_square();
  std::string text =
      fmt::format("chi^2 {:.4g} a degree of freedom, {:.4g} with the rig file's numbers", reduced,
                  c.fit.before.chi_square / c.fit.freedom);
  if (c.fit.inflation() > 1.0) {
    text += fmt::format(
        "; the model and [sensors] do not explain all of it, so every sigma is "
        "{:.3g} times larger",
        c.fit.inflation());
  }
  return text;
}

std::string correlations(const Calibration& c) {
  std::string text;
  for (std::size_t i = 0; i < c.findings.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double r =
          c.known.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (!(std::abs(r) > 0.9)) continue;
      text += fmt::format("  {} and {}: {:+.3f}\n", c.findings[j].key, c.findings[i].key, r);
    }
  }
  return text.empty() ? text : "correlated by more than 0.9:\n" + text;
}

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

}  // namespace

std::string text_of(const Calibration& c) {
  std::string text = fmt::format("{}: {} from {:.4g} s in {} stretches, {} readings\n", c.rig,
                                 fmt::join(c.files, ", "), seconds_of(c), c.stretches.size(),
                                 c.fit.after.points.size());
  text += agreement_text(c) + "\n\n";
  std::size_t width = 3;
  for (const Finding& finding : c.findings) width = std::max(width, finding.key.size());
  text +=
      fmt::format("{:<{}}  {:>12}  {:>14}  {:>20}\n", "key", width, "rig file", "found", "sigma");
  for (const Finding& finding : c.findings) {
    text += fmt::format("{:<{}}  {:>12.6g}  {:>14}  {:>20}\n", finding.key, width, finding.start,
                        value_text(finding), sigma_text(finding));
  }
  for (const Finding& finding : c.findings) {
    if (finding.identified()) continue;
    text += fmt::format("\nrefused {}: {}\n", finding.key, finding.refusal);
    if (!finding.advice.empty()) text += "  " + finding.advice + "\n";
  }
  const std::string correlated = correlations(c);
  if (!correlated.empty()) text += "\n" + correlated;
  text += "\nsensor, rms of (predicted - measured) / sigma   before    after\n";
  for (const int reading : c.fit.after.readings()) {
    text += fmt::format("{:<44}  {:>8.3f} {:>8.3f}\n", name_of_reading(reading),
                        c.fit.before.rms(reading), c.fit.after.rms(reading));
  }
  return text;
}

std::string json_of(const Calibration& c) {
  Json json{{"rig", c.rig},
            {"logs", c.files},
            {"seconds", seconds_of(c)},
            {"stretches", c.stretches.size()},
            {"readings", c.fit.after.points.size()},
            {"chi_square", c.fit.after.chi_square},
            {"chi_square_before", c.fit.before.chi_square},
            {"degrees_of_freedom", c.fit.freedom},
            {"sigma_inflation", c.fit.inflation()},
            {"iterations", c.fit.iterations},
            {"ending", c.fit.ending}};
  for (const Finding& finding : c.findings) {
    json["parameters"].push_back({{"key", finding.key},
                                  {"start", finding.start},
                                  {"value", finding.value},
                                  {"sigma", number(finding.sigma)},
                                  {"sigma_if_others_known_relative", number(finding.alone)},
                                  {"identified", finding.identified()},
                                  {"refusal", finding.refusal},
                                  {"advice", finding.advice}});
  }
  const auto n = static_cast<Eigen::Index>(c.findings.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    Json row = Json::array();
    Json direction = Json::array();
    for (Eigen::Index j = 0; j < n; ++j) {
      const double scale = std::abs(c.findings[static_cast<std::size_t>(i)].start *
                                    c.findings[static_cast<std::size_t>(j)].start);
      row.push_back(number(scale * c.known.covariance(i, j)));
      direction.push_back(c.known.directions(j, i));
    }
    json["covariance"].push_back(row);
    json["singular_values"].push_back({{"value", c.known.singular[i]}, {"direction", direction}});
  }
  for (std::size_t i = 0; i < c.fit.biases.size(); ++i) {
    json["biases"].push_back(
        {{"sensor", name_of_reading(c.fit.biases[i].reading)}, {"value", c.fit.bias[i]}});
  }
  for (const int reading : c.fit.after.readings()) {
    json["sensors"].push_back({{"sensor", name_of_reading(reading)},
                               {"rms_before", c.fit.before.rms(reading)},
                               {"rms_after", c.fit.after.rms(reading)}});
  }
  return json.dump(1) + "\n";
}

namespace {

/// (predicted - measured) of one reading over time; the stretches one behind the other.
Curve residual_curve(const Calibration& c, const Agreement& agreement, int reading) {
  std::map<const Stretch*, double> offset;
  double at = 0.0;
  for (const Stretch& stretch : c.stretches) {
    offset[&stretch] = at - stretch.tick_s * static_cast<double>(stretch.moments.front().tick);
    at += stretch.seconds();
  }
  Curve curve;
  curve.style = Curve::Style::kPoints;
  std::size_t count = 0;
  for (const Point& p : agreement.points) count += p.reading == reading ? 1 : 0;
  const std::size_t every = count / kPointsDrawn + 1;
  std::size_t seen = 0;
  for (const Point& p : agreement.points) {
    if (p.reading != reading || seen++ % every != 0) continue;
    curve.x.push_back(offset[p.stretch] + p.t);
    curve.y.push_back(p.predicted - p.measured);
  }
  return curve;
}

void add_residuals(const Calibration& c, Page& page) {
  page.heading("Predicted minus measured");
  page.paragraph(
      "Before: with the rig file's numbers; after: with those found. States and biases "
      "are the best ones in both. Lines: two standard deviations of a sample.");
  for (const int reading : c.fit.after.readings()) {
    Chart chart;
    chart.title = name_of_reading(reading);
    chart.x.label = "time of all stretches [s]";
    chart.y.label = fmt::format("{} [{}]", chart.title, unit_of(kind_of(reading)));
    chart.curves = {residual_curve(c, c.fit.before, reading),
                    residual_curve(c, c.fit.after, reading)};
    chart.curves[0].name = "before";
    chart.curves[1].name = "after";
    const double sigma = std::ranges::find(c.fit.after.points, reading, &Point::reading)->sigma;
    chart.rules = {{Rule::Direction::kHorizontal, 2.0 * sigma, ""},
                   {Rule::Direction::kHorizontal, -2.0 * sigma, ""}};
    page.figure(svg(chart), fmt::format("rms over sigma: before {:.3f}, after {:.3f}",
                                        c.fit.before.rms(reading), c.fit.after.rms(reading)));
  }
}

std::string verdict_sentence(const Calibration& c) {
  const auto identified = std::ranges::count_if(c.findings, &Finding::identified);
  return fmt::format("{} of {} parameters identified", identified, c.findings.size());
}

}  // namespace

std::string page_of(const Calibration& c) {
  Page page(fmt::format("{}: calibration", c.rig), fmt::format("{}", fmt::join(c.files, ", ")));
  const bool all = std::ranges::all_of(c.findings, &Finding::identified);
  page.verdict(all ? Tone::kGood : Tone::kDoubtful, verdict_sentence(c), agreement_text(c));
  std::vector<std::vector<std::string>> rows;
  std::vector<Tone> tones;
  for (const Finding& finding : c.findings) {
    rows.push_back({finding.key, fmt::format("{:.6g}", finding.start), value_text(finding),
                    sigma_text(finding), finding.refusal, finding.advice});
    tones.push_back(finding.identified() ? Tone::kGood : Tone::kBad);
  }
  page.heading("Parameters");
  page.table({"key", "rig file", "found", "sigma", "why not", "what would tell it"}, rows, tones);
  add_residuals(c, page);
  page.heading("All figures");
  page.listing("As JSON", json_of(c));
  return page.html();
}

std::string rig_file_of(const Calibration& c, const std::string& document) {
  std::vector<NewValue> values;
  for (const Finding& finding : c.findings) {
    if (!finding.identified()) continue;
    values.push_back({finding.key, number_with_sigma(finding.value, finding.sigma),
                      fmt::format("measured: sigma {:.2g} ({:.2g} %), {}", finding.sigma,
                                  100.0 * finding.relative(), fmt::join(c.files, ", "))});
  }
  return with_values(document, values);
}

}  // namespace gyrotwin::calibration
