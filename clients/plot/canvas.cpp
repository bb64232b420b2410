#include "clients/plot/canvas.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

constexpr double kWidth = 640.0;
constexpr double kLetter = 6.6;  // width of one, about
constexpr double kLegendLine = 18.0;
constexpr int kColours = 7;

// Okabe and Ito's colours, which the colour-blind can tell apart; lighter ones on a dark ground.
constexpr const char* kStyle =
    "<style>.gt{--ink:#1b1f24;--soft:#59636e;--grid:#dfe3e8;--back:#ffffff;--c0:#0072b2;"
    "--c1:#d55e00;--c2:#009e73;--c3:#b0548a;--c4:#b07a00;--c5:#2f8fc4;--c6:#6b7280;"
    "font:12px system-ui,sans-serif;fill:var(--ink)}"
    "@media(prefers-color-scheme:dark){.gt{--ink:#e6e9ec;--soft:#9aa5b1;--grid:#30363d;"
    "--back:#14181d;--c0:#4ea8e0;--c1:#ff8c42;--c2:#2bc79d;--c3:#e39ac4;--c4:#f2b134;"
    "--c5:#8fd0f5;--c6:#a7b0ba}}"
    ".gt .t{font-size:14px;font-weight:600}.gt .s{fill:var(--soft)}"
    ".gt .g{stroke:var(--grid);stroke-width:1}.gt .f{fill:none;stroke:var(--soft)}"
    ".gt .l{fill:none;stroke-width:1.8;stroke-linejoin:round}.gt .d{stroke-dasharray:6 4}"
    ".gt .r{stroke:var(--soft);stroke-width:1.2;stroke-dasharray:2 3}"
    ".gt .k0{stroke:var(--c0)}.gt .k1{stroke:var(--c1)}.gt .k2{stroke:var(--c2)}"
    ".gt .k3{stroke:var(--c3)}.gt .k4{stroke:var(--c4)}.gt .k5{stroke:var(--c5)}"
    ".gt .k6{stroke:var(--c6)}.gt .p0{fill:var(--c0)}.gt .p1{fill:var(--c1)}"
    ".gt .p2{fill:var(--c2)}.gt .p3{fill:var(--c3)}.gt .p4{fill:var(--c4)}"
    ".gt .p5{fill:var(--c5)}.gt .p6{fill:var(--c6)}</style>";

std::string text_at(double x, double y, const char* anchor, const char* style,
                    const std::string& text) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}' class='{}'>{}</text>", x, y,
                     anchor, style, escaped(text));
}

/// Where legend entries go, line by line.
struct LegendPlan {
  std::vector<double> x, y;
  double height = 0.0;
};

LegendPlan plan(const std::vector<LegendEntry>& legend, double left, double right, double top) {
  LegendPlan plan;
  double x = left, y = top;
  for (const LegendEntry& entry : legend) {
    const double width = 28.0 + kLetter * static_cast<double>(entry.name.size()) + 16.0;
    if (x > left && x + width > right) {
      x = left;
      y += kLegendLine;
    }
    plan.x.push_back(x);
    plan.y.push_back(y);
    x += width;
  }
  plan.height = legend.empty() ? 0.0 : y - top + kLegendLine;
  return plan;
}

/// A curve's points in pixels, thinned to what can be seen: of one pixel column the first, lowest,
/// highest and last, where the curve runs along the axis; else what is apart.
class Thinner {
 public:
  void add(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return finish();
    const double column = std::floor(x);
    if (count_ > 0 && column == column_) {
      low_ = std::min(low_, y);
      high_ = std::max(high_, y);
      last_x_ = x;
      last_y_ = y;
      ++count_;
      return;
    }
    flush();
    column_ = column;
    low_ = high_ = last_y_ = y;
    last_x_ = x;
    count_ = 1;
    put(x, y);
  }
  void finish() {
    flush();
    count_ = 0;
    fresh_ = true;
  }
  std::string path;

 private:
  void flush() {
    if (count_ < 2) return;
    if (count_ > 3) {
      put(last_x_, low_);
      put(last_x_, high_);
    }
    put(last_x_, last_y_);
  }
  void put(double x, double y) {
    path += fmt::format("{}{:.1f} {:.1f}", fresh_ ? "M" : "L", x, y);
    fresh_ = false;
  }
  bool fresh_ = true;
  int count_ = 0;
  double column_ = 0.0, low_ = 0.0, high_ = 0.0, last_x_ = 0.0, last_y_ = 0.0;
};

bool runs_forward(const std::vector<double>& x) { return std::is_sorted(x.begin(), x.end()); }

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

Canvas::Canvas(const std::string& title, const Axis& x, const Axis& y, std::span<const double> xs,
               std::span<const double> ys, const std::vector<LegendEntry>& legend, double right,
               double height)
    : title_(title),
      height_(height),
      left_(72.0),
      right_(kWidth - right),
      top_(34.0 + plan(legend, 72.0, kWidth - 16.0, 0.0).height),
      bottom_(height - 50.0),
      x_(x, xs, left_, right_),
      y_(y, ys, bottom_, top_) {
  frame_ += text_at(left_, 20.0, "start", "t", title);
  const LegendPlan places = plan(legend, left_, kWidth - 16.0, 38.0);
  for (std::size_t i = 0; i < legend.size(); ++i) {
    frame_ += fmt::format("<g transform='translate({:.1f} {:.1f})'>{}</g>", places.x[i],
                          places.y[i] - 9.0, legend[i].sample);
    frame_ += text_at(places.x[i] + 28.0, places.y[i], "start", "", legend[i].name);
  }
  draw_axes(x, y);
  if (xs.empty()) {
    annotate(text_at(0.5 * (left_ + right_), 0.5 * (top_ + bottom_), "middle", "s", "no data"));
  }
}

void Canvas::draw_axes(const Axis& x, const Axis& y) {
  const std::vector<double> across = x_.ticks(7);
  const std::vector<double> up = y_.ticks(6);
  const auto step = [](const std::vector<double>& ticks) {
    return ticks.size() > 1 ? std::abs(ticks[1] - ticks[0]) : 1.0;
  };
  for (const double value : across) {
    const double at = x_.pixel(value);
    frame_ += fmt::format("<line x1='{0:.1f}' y1='{1:.1f}' x2='{0:.1f}' y2='{2:.1f}' class='g'/>",
                          at, top_, bottom_);
    frame_ += text_at(at, bottom_ + 16.0, "middle", "s",
                      tick_label(value, x.logarithmic ? value : step(across)));
  }
  for (const double value : up) {
    const double at = y_.pixel(value);
    frame_ += fmt::format("<line x1='{1:.1f}' y1='{0:.1f}' x2='{2:.1f}' y2='{0:.1f}' class='g'/>",
                          at, left_, right_);
    frame_ += text_at(left_ - 7.0, at + 4.0, "end", "s",
                      tick_label(value, y.logarithmic ? value : step(up)));
  }
  outside_ += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' class='f'/>",
                          left_, top_, right_ - left_, bottom_ - top_);
  frame_ += text_at(0.5 * (left_ + right_), bottom_ + 38.0, "middle", "", x.label);
  frame_ += fmt::format(
      "<text transform='translate(16 {:.1f}) rotate(-90)' text-anchor='middle'>{}</text>",
      0.5 * (top_ + bottom_), escaped(y.label));
}

void Canvas::draw_curve(const Curve& curve, int colour) {
  const int k = colour % kColours;
  if (curve.style == Curve::Style::kPoints || curve.style == Curve::Style::kCrosses) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const double x = x_.pixel(curve.x[i]);
      const double y = y_.pixel(curve.y[i]);
      if (!std::isfinite(x) || !std::isfinite(y) || !x_.shows(curve.x[i]) ||
          !y_.shows(curve.y[i])) {
        continue;
      }
      inside_ += curve.style == Curve::Style::kPoints
                     ? fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2.6' class='p{}'/>", x, y, k)
                     : fmt::format("<path d='M{:.1f} {:.1f}l8 8m0 -8l-8 8' class='l k{}'/>",
                                   x - 4.0, y - 4.0, k);
    }
    return;
  }
  Thinner thinner;
  const bool forward = runs_forward(curve.x);
  double last_x = 0.0, last_y = 0.0;
  bool first = true;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = x_.pixel(curve.x[i]);
    const double y = std::clamp(y_.pixel(curve.y[i]), -1e4, 1e4);
    if (!forward && !first && std::hypot(x - last_x, y - last_y) < 0.4 && i + 1 < curve.x.size()) {
      continue;
    }
    if (forward) {
      thinner.add(x, y);
    } else if (std::isfinite(x) && std::isfinite(y)) {
      thinner.path += fmt::format("{}{:.1f} {:.1f}", first ? "M" : "L", x, y);
    }
    first = !std::isfinite(x) || !std::isfinite(y);
    last_x = x;
    last_y = y;
  }
  thinner.finish();
  if (thinner.path.empty()) return;
  inside_ += fmt::format("<path d='{}' class='l k{}{}'/>", thinner.path, k,
                         curve.style == Curve::Style::kDashed ? " d" : "");
}

std::string Canvas::svg() const {
  return fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' class='gt' viewBox='0 0 {0:.0f} {1:.0f}' role='img' "
      "aria-label='{2}'><title>{2}</title>{3}<rect width='{0:.0f}' height='{1:.0f}' "
      "style='fill:var(--back)'/>{4}<svg x='{5:.1f}' y='{6:.1f}' width='{7:.1f}' height='{8:.1f}' "
      "viewBox='{5:.1f} {6:.1f} {7:.1f} {8:.1f}' style='overflow:hidden'>{9}</svg>{10}</svg>",
      kWidth, height_, escaped(title_), kStyle, frame_, left_, top_, right_ - left_, bottom_ - top_,
      inside_, outside_);
}

std::string curve_sample(const Curve& curve, int colour) {
  const int k = colour % kColours;
  switch (curve.style) {
    case Curve::Style::kLine:
      return fmt::format("<path d='M0 5h22' class='l k{}'/>", k);
    case Curve::Style::kDashed:
      return fmt::format("<path d='M0 5h22' class='l d k{}'/>", k);
    case Curve::Style::kPoints:
      return fmt::format("<circle cx='11' cy='5' r='3' class='p{}'/>", k);
    case Curve::Style::kCrosses:
      return fmt::format("<path d='M7 1l8 8m0 -8l-8 8' class='l k{}'/>", k);
  }
  return "";
}

}  // namespace gyrotwin
