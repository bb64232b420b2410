#include "clients/sweep/summary_charts.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "clients/common/tilt.hpp"
#include "clients/plot/chart.hpp"
#include "clients/sweep/statistics.hpp"

namespace gyrotwin {

namespace {

constexpr int kBins = 10;
constexpr std::size_t kMostDrawn = 6;      // charts of single drawn factors
constexpr std::size_t kMostPoints = 4000;  // of a scatter
constexpr std::size_t kMostLevels = 400;   // of one side of a map
constexpr double kAir = 4.0;               // beyond 0 and 100 % [%]
constexpr int kStandColour = 0, kFallColour = 1;

std::vector<const Factor*> lists_of(const Results& results) {
  std::vector<const Factor*> lists;
  for (const Factor& factor : results.factors) {
    if (!factor.drawn && factor.levels().size() > 1) lists.push_back(&factor);
  }
  return lists;
}

/// A start's unit is not in its name.
std::string label_of(const Factor& factor) {
  if (!factor.key.starts_with("start.")) return factor.key;
  return factor.key + (factor.key.ends_with("_dot") ? " [rad/s]" : " [rad]");
}

std::size_t level_index(const std::vector<double>& levels, double value) {
  return static_cast<std::size_t>(std::ranges::lower_bound(levels, value) - levels.begin());
}

/// Stands and falls of the runs in each cell.
struct Tally {
  std::vector<std::int64_t> stand, all;
  explicit Tally(std::size_t cells) : stand(cells), all(cells) {}
  void note(std::size_t cell, bool stands) {
    ++all[cell];
    stand[cell] += stands ? 1 : 0;
  }
};

CaptionedSvg map_over(const Factor& across, const Factor& up, const Results& results) {
  CellMap map;
  map.title = "Stands and falls";
  map.x.label = label_of(across);
  map.y.label = label_of(up);
  map.xs = across.levels();
  map.ys = up.levels();
  const std::size_t width = map.xs.size();
  Tally tally(width * map.ys.size());
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (!results.counts(i)) continue;
    tally.note(level_index(map.ys, up.numbers[i]) * width + level_index(map.xs, across.numbers[i]),
               results.stands(i));
  }
  const bool single = std::ranges::all_of(tally.all, [](std::int64_t n) { return n <= 1; });
  for (std::size_t cell = 0; cell < tally.all.size(); ++cell) {
    const Proportion p = proportion(tally.stand[cell], tally.all[cell]);
    map.values.push_back(tally.all[cell] == 0 ? std::numeric_limits<double>::quiet_NaN()
                         : single             ? (tally.stand[cell] > 0 ? 0.0 : 1.0)
                                              : 100.0 * (1.0 - p.share));
  }
  if (single) {
    map.kinds = {"stands", "does not"};
    return {svg(map), "Every cell is one run; empty: there is no such rig."};
  }
  map.title = "How many do not stand";
  map.value_label = "do not stand [%]";
  return {svg(map), "Share of each cell's runs that do not stand; empty: there is no such rig."};
}

/// Share that stands over `places`, with the interval that the number of runs allows.
/// @param pooled over other listed values, which are no sample: there is no interval
CaptionedSvg shares_over(const Factor& factor, const std::vector<double>& places,
                         const Tally& tally, bool pooled) {
  Chart chart;
  chart.title = "How many stand over " + factor.key;
  chart.x.label = label_of(factor);
  chart.y = {"stand [%]", -kAir, 100.0 + kAir};
  std::array<Curve, 3> curves;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (tally.all[i] == 0) continue;
    const Proportion p = proportion(tally.stand[i], tally.all[i]);
    const std::array<double, 3> heights{p.share, p.low, p.high};
    for (std::size_t c = 0; c < curves.size(); ++c) {
      curves[c].x.push_back(places[i]);
      curves[c].y.push_back(100.0 * heights[c]);
    }
  }
  curves[0].name = "stand";
  curves[1].name = "95 % confidence";
  for (std::size_t c = 0; c < (pooled ? 1 : curves.size()); ++c) {
    curves[c].colour = c == 0 ? kStandColour : 6;
    curves[c].style = c == 0 ? Curve::Style::kLine : Curve::Style::kDashed;
    chart.curves.push_back(curves[c]);
  }
  return {svg(chart), pooled ? "Share of the runs with these values that stand."
                             : "Share of runs that stand, and where the true one is with 95 % "
                               "confidence."};
}

CaptionedSvg shares_by_level(const Factor& factor, const Results& results, bool pooled) {
  const std::vector<double> levels = factor.levels();
  Tally tally(levels.size());
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (results.counts(i)) tally.note(level_index(levels, factor.numbers[i]), results.stands(i));
  }
  return shares_over(factor, levels, tally, pooled);
}

/// In bins of as many runs each.
CaptionedSvg shares_by_quantile(const Factor& factor, const Results& results) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (results.counts(i)) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return factor.numbers[i]; });
  const std::size_t bins = std::min<std::size_t>(kBins, order.size());
  Tally tally(bins);
  std::vector<double> places(bins, 0.0);
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t bin = place * bins / order.size();
    tally.note(bin, results.stands(order[place]));
    places[bin] += factor.numbers[order[place]];
  }
  for (std::size_t bin = 0; bin < bins; ++bin) places[bin] /= static_cast<double>(tally.all[bin]);
  return shares_over(factor, places, tally, !lists_of(results).empty());
}

bool any_tilt(const Results& results) {
  return std::ranges::any_of(results.largest_tilt, [](double x) { return std::isfinite(x); });
}

/// A point for each of the first `runs`, by whether it stands.
template <class Height>
std::vector<Curve> points(const Factor& across, const Results& results, std::size_t runs,
                          const Height& height) {
  std::vector<Curve> curves{{"stands", {}, {}, Curve::Style::kPoints, kStandColour},
                            {"does not", {}, {}, Curve::Style::kCrosses, kFallColour}};
  for (std::size_t i = 0; i < runs; ++i) {
    if (!results.counts(i)) continue;
    Curve& curve = curves[results.stands(i) ? 0 : 1];
    curve.x.push_back(across.numbers[i]);
    curve.y.push_back(height(i));
  }
  return curves;
}

/// Largest tilt of single runs over a list.
CaptionedSvg tilts_over(const Factor& factor, const Results& results, double fall_tilt) {
  Chart chart;
  chart.title = "Largest tilt over " + factor.key;
  chart.x.label = label_of(factor);
  chart.y = {"largest tilt [deg]", 0.0, 1.2 * degrees(fall_tilt)};
  chart.curves = points(factor, results, results.runs(),
                        [&](std::size_t i) { return degrees(results.largest_tilt[i]); });
  chart.rules.push_back({Rule::Direction::kHorizontal, degrees(fall_tilt), "fallen"});
  return {svg(chart), "Every point is one run."};
}

CaptionedSvg scatter(const Factor& across, const Factor& up, const Results& results) {
  Chart chart;
  chart.title = "Single runs";
  chart.x.label = label_of(across);
  chart.y.label = label_of(up);
  const std::size_t runs = std::min(results.runs(), kMostPoints);
  chart.curves = points(across, results, runs, [&](std::size_t i) { return up.numbers[i]; });
  return {
      svg(chart),
      fmt::format(
          "{}{}.",
          influence(up, results).matters()       ? "The two drawn values that matter most"
          : influence(across, results).matters() ? "The drawn value that matters most, and another"
                                                 : "Two drawn values; none is seen to matter",
          results.runs() > kMostPoints ? fmt::format(", the first {} runs", kMostPoints) : "")};
}

/// Runs that tilt at most so far, among those that count.
CaptionedSvg tilt_distribution(const Results& results, double fall_tilt) {
  std::vector<double> tilts;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (results.counts(i) && std::isfinite(results.largest_tilt[i])) {
      tilts.push_back(degrees(results.largest_tilt[i]));
    }
  }
  std::ranges::sort(tilts);
  Chart chart;
  chart.title = "How far they tilt";
  chart.x = {"largest tilt [deg]", 0.0, 1.2 * degrees(fall_tilt)};
  chart.y = {"runs that tilt no further [%]", -kAir, 100.0 + kAir};
  Curve curve;
  curve.name = "";
  for (std::size_t i = 0; i < tilts.size(); ++i) {
    const double n = static_cast<double>(tilts.size());
    curve.x.insert(curve.x.end(), 2, tilts[i]);
    curve.y.push_back(100.0 * static_cast<double>(i) / n);
    curve.y.push_back(100.0 * static_cast<double>(i + 1) / n);
  }
  chart.curves.push_back(curve);
  chart.rules.push_back({Rule::Direction::kVertical, degrees(fall_tilt), "fallen"});
  return {svg(chart), "Share of all runs whose largest tilt is at most that on the axis."};
}

}  // namespace

namespace {

Influence correlations(const Factor& factor, const Results& results) {
  std::vector<double> x, stands, tilted, tilt;
  for (std::size_t i = 0; i < results.runs(); ++i) {
    if (!results.counts(i)) continue;
    x.push_back(factor.numbers[i]);
    stands.push_back(results.stands(i) ? 1.0 : 0.0);
    if (!std::isfinite(results.largest_tilt[i])) continue;  // it has none
    tilted.push_back(factor.numbers[i]);
    tilt.push_back(results.largest_tilt[i]);
  }
  return {rank_correlation(x, stands), rank_correlation(tilted, tilt), x.size()};
}

}  // namespace

double Influence::strength() const {
  return std::fmax(0.0, std::fmax(std::abs(standing), std::abs(tilt)));
}

bool Influence::matters() const {
  return strength() >= std::max(0.005, 2.0 / std::sqrt(static_cast<double>(runs)));
}

Influence influence(const Factor& factor, const Results& results) {
  const Influence plain = correlations(factor, results);
  Influence by_size = correlations(factor.sizes(), results);
  by_size.by_size = true;
  return by_size.strength() > 1.5 * plain.strength() ? by_size : plain;
}

std::vector<const Factor*> by_influence(const Results& results) {
  std::vector<std::pair<double, const Factor*>> known;
  for (const Factor& factor : results.factors) {
    if (!factor.quantity || factor.levels().size() < 2) continue;
    known.emplace_back(influence(factor, results).strength(), &factor);
  }
  std::ranges::stable_sort(known, std::greater<>{}, [](const auto& entry) { return entry.first; });
  std::vector<const Factor*> order;
  for (const auto& [size, factor] : known) order.push_back(factor);
  return order;
}

std::vector<CaptionedSvg> summary_charts(const Results& results, double fall_tilt) {
  std::vector<CaptionedSvg> all;
  const std::vector<const Factor*> lists = lists_of(results);
  for (std::size_t i = 0; i + 1 < lists.size(); ++i) {
    if (std::max(lists[i]->levels().size(), lists[i + 1]->levels().size()) > kMostLevels) continue;
    all.push_back(map_over(*lists[i], *lists[i + 1], results));
  }
  const bool drawn_any =
      std::ranges::any_of(results.factors, [](const Factor& factor) { return factor.drawn; });
  if (lists.size() == 1 && !drawn_any && any_tilt(results)) {
    all.push_back(tilts_over(*lists[0], results, fall_tilt));
  } else if (drawn_any || lists.size() == 1) {
    for (const Factor* list : lists) {
      all.push_back(shares_by_level(*list, results, lists.size() > 1));
    }
  }
  std::vector<const Factor*> drawn = by_influence(results);
  std::erase_if(drawn, [](const Factor* factor) { return !factor->drawn; });
  if (drawn.size() > 1) all.push_back(scatter(*drawn[0], *drawn[1], results));
  drawn.resize(std::min(drawn.size(), kMostDrawn));
  for (const Factor* factor : drawn) all.push_back(shares_by_quantile(*factor, results));
  if (any_tilt(results)) all.push_back(tilt_distribution(results, fall_tilt));
  return all;
}

}  // namespace gyrotwin
