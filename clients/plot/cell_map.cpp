#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "clients/plot/canvas.hpp"
#include "clients/plot/chart.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr int kKinds = 5;
// Light grounds under dark hatches: told apart without colour too.
constexpr std::array<const char*, kKinds> kFills{"#9ecae8", "#f3b48c", "#f2e394", "#d9b8d0",
                                                 "#c7ccd1"};
constexpr std::array<const char*, kKinds> kHatches{"", "M0 8L8 0", "M4 4h.01", "M0 0L8 8M0 8L8 0",
                                                   "M0 4h8"};

std::string hatch_id(int kind) { return fmt::format("gt-hatch-{}", kind); }

std::string hatches() {
  std::string defs = "<defs>";
  for (int kind = 1; kind < kKinds; ++kind) {
    defs += fmt::format(
        "<pattern id='{}' width='8' height='8' patternUnits='userSpaceOnUse'><path d='{}' "
        "fill='none' stroke='#3a3f45' stroke-width='{}' stroke-linecap='round'/></pattern>",
        hatch_id(kind), kHatches[static_cast<std::size_t>(kind)], kind == 2 ? "2" : ".8");
  }
  return defs + "</defs>";
}

std::string rectangle(double x, double y, double width, double height, const std::string& fill) {
  return fmt::format("<rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{:.2f}' fill='{}'/>", x, y,
                     width, height, fill);
}

/// White at zero, towards vermilion above and blue below; the strongest at `largest`.
std::string colour_of(double value, double largest) {
  const double share = std::sqrt(std::min(1.0, std::abs(value) / largest));
  const std::array<double, 3> strong =
      value > 0.0 ? std::array{213.0, 94.0, 0.0} : std::array{0.0, 114.0, 178.0};
  std::array<int, 3> mixed{};
  for (std::size_t i = 0; i < 3; ++i) {
    mixed[i] = static_cast<int>(std::lround(250.0 + share * (strong[i] - 250.0)));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2]);
}

/// Middles between neighbours, and as far beyond the outermost.
std::vector<double> borders(const std::vector<double>& centres) {
  std::vector<double> borders;
  if (centres.size() == 1) return {centres[0] - 0.5, centres[0] + 0.5};
  borders.push_back(centres[0] - 0.5 * (centres[1] - centres[0]));
  for (std::size_t i = 1; i < centres.size(); ++i) {
    borders.push_back(0.5 * (centres[i - 1] + centres[i]));
  }
  borders.push_back(centres.back() + 0.5 * (centres.back() - centres[centres.size() - 2]));
  return borders;
}

void check(const CellMap& map) {
  if (map.values.size() == map.xs.size() * map.ys.size()) return;
  throw Error(fmt::format("map `{}`: {} values for {} x {} cells", map.title, map.values.size(),
                          map.xs.size(), map.ys.size()));
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double x : values) {
    if (std::isfinite(x)) most = std::max(most, std::abs(x));
  }
  return most > 0.0 ? most : 1.0;
}

void draw_bar(const CellMap& map, double most, Canvas& canvas) {
  constexpr int kSteps = 40;
  double low = 0.0, high = 0.0;
  for (const double x : map.values) {
    if (!std::isfinite(x)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  if (low == high) high = 1.0;
  const Axis axis{map.value_label, low, high};
  const Scale scale(axis, {}, canvas.bottom(), canvas.top());
  const double left = canvas.right() + 14.0;
  for (int i = 0; i < kSteps; ++i) {
    const double from = low + (high - low) * i / kSteps;
    const double to = low + (high - low) * (i + 1) / kSteps;
    canvas.annotate(rectangle(left, scale.pixel(to), 14.0,
                              scale.pixel(from) - scale.pixel(to) + 0.5,
                              colour_of(0.5 * (from + to), most)));
  }
  const std::vector<double> ticks = scale.ticks(5);
  for (const double tick : ticks) {
    canvas.annotate(fmt::format("<text x='{:.1f}' y='{:.1f}' class='s'>{}</text>", left + 19.0,
                                scale.pixel(tick) + 4.0,
                                tick_label(tick, ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0)));
  }
  canvas.annotate(fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='end'>{}</text>", 632.0,
                              canvas.bottom() + 38.0, escaped(map.value_label)));
}

std::vector<LegendEntry> legend_of(const CellMap& map) {
  std::vector<LegendEntry> legend;
  for (std::size_t kind = 0; kind < map.kinds.size(); ++kind) {
    std::string sample = rectangle(0, 0, 22, 11, kFills[kind % kKinds]);
    if (kind > 0) {
      sample += rectangle(0, 0, 22, 11, "url(#" + hatch_id(static_cast<int>(kind) % kKinds) + ")");
    }
    legend.push_back({map.kinds[kind], sample});
  }
  for (const Curve& curve : map.curves) {
    if (!curve.name.empty()) legend.push_back({curve.name, curve_sample(curve, 6)});
  }
  return legend;
}

}  // namespace

std::string svg(const CellMap& map) {
  check(map);
  const std::vector<double> x = map.xs.empty() ? std::vector<double>{} : borders(map.xs);
  const std::vector<double> y = map.ys.empty() ? std::vector<double>{} : borders(map.ys);
  Axis across = map.x, up = map.y;
  if (!x.empty()) {
    across.low = across.low.value_or(x.front());
    across.high = across.high.value_or(x.back());
    up.low = up.low.value_or(y.front());
    up.high = up.high.value_or(y.back());
  }
  Canvas canvas(map.title, across, up, x, y, legend_of(map), map.kinds.empty() ? 76.0 : 16.0);
  const double most = largest(map.values);
  if (!map.kinds.empty()) canvas.annotate(hatches());
  for (std::size_t j = 0; j < map.ys.size(); ++j) {
    for (std::size_t i = 0; i < map.xs.size(); ++i) {
      const double value = map.values[j * map.xs.size() + i];
      if (!std::isfinite(value)) continue;
      const double left = canvas.x().pixel(x[i]), top = canvas.y().pixel(y[j + 1]);
      const double width = canvas.x().pixel(x[i + 1]) - left;
      const double height = canvas.y().pixel(y[j]) - top;
      if (map.kinds.empty()) {
        canvas.draw(rectangle(left, top, width + 0.3, height + 0.3, colour_of(value, most)));
        continue;
      }
      const int kind = static_cast<int>(value) % kKinds;
      canvas.draw(
          rectangle(left, top, width + 0.3, height + 0.3, kFills[static_cast<std::size_t>(kind)]));
      if (kind > 0) {
        canvas.draw(rectangle(left, top, width, height, "url(#" + hatch_id(kind) + ")"));
      }
    }
  }
  for (const Curve& curve : map.curves) canvas.draw_curve(curve, 6);
  if (map.kinds.empty() && !map.xs.empty()) draw_bar(map, most, canvas);
  return canvas.svg();
}

}  // namespace gyrotwin
