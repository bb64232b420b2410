#include "clients/plot/chart.hpp"

#include <spdlog/fmt/fmt.h>

#include "clients/plot/canvas.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

void check(const std::string& title, const std::vector<Curve>& curves) {
  for (const Curve& curve : curves) {
    if (curve.x.size() == curve.y.size()) continue;
    throw Error(fmt::format("chart `{}`: curve `{}` has {} abscissae and {} ordinates", title,
                            curve.name, curve.x.size(), curve.y.size()));
  }
}

void draw_rule(const Rule& rule, Canvas& canvas) {
  const bool across = rule.direction == Rule::Direction::kHorizontal;
  const Scale& scale = across ? canvas.y() : canvas.x();
  if (!scale.shows(rule.at)) return;
  const double at = scale.pixel(rule.at);
  if (across) {
    canvas.annotate(fmt::format("<path d='M{:.1f} {:.1f}H{:.1f}' class='r'/>", canvas.left(), at,
                                canvas.right()));
    canvas.annotate(fmt::format(
        "<text x='{:.1f}' y='{:.1f}' text-anchor='end' class='s'>{}</text>", canvas.right() - 5.0,
        at < canvas.top() + 18.0 ? at + 14.0 : at - 5.0, escaped(rule.text)));
  } else {
    canvas.annotate(fmt::format("<path d='M{:.1f} {:.1f}V{:.1f}' class='r'/>", at, canvas.top(),
                                canvas.bottom()));
    const bool near_right = at > canvas.right() - 90.0;
    canvas.annotate(fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}' class='s'>{}</text>",
                                near_right ? at - 5.0 : at + 5.0, canvas.top() + 14.0,
                                near_right ? "end" : "start", escaped(rule.text)));
  }
}

}  // namespace

std::string svg(const Chart& chart) {
  check(chart.title, chart.curves);
  std::vector<double> xs, ys;
  std::vector<LegendEntry> legend;
  int colour = 0;
  for (const Curve& curve : chart.curves) {
    xs.insert(xs.end(), curve.x.begin(), curve.x.end());
    ys.insert(ys.end(), curve.y.begin(), curve.y.end());
    if (!curve.name.empty())
      legend.push_back({curve.name, curve_sample(curve, curve.colour.value_or(colour))});
    ++colour;
  }
  Canvas canvas(chart.title, chart.x, chart.y, xs, ys, legend, 16.0, chart.height);
  colour = 0;
  for (const Curve& curve : chart.curves) {
    canvas.draw_curve(curve, curve.colour.value_or(colour));
    ++colour;
  }
  for (const Rule& rule : chart.rules) draw_rule(rule, canvas);
  return canvas.svg();
}

}  // namespace gyrotwin
