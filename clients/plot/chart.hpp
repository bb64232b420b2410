// Charts as SVG text: what reports show. Pure: numbers in, text out, the same numbers the same
// text.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace gyrotwin {

/// "tilt [deg]"; limits that are absent are those of the data.
struct Axis {
  std::string label;
  std::optional<double> low = {}, high = {};
  bool logarithmic = false;
};

/// A curve or points of one colour. A coordinate that is not finite interrupts it.
struct Curve {
  enum class Style { kLine, kDashed, kPoints, kCrosses };
  std::string name;  ///< in the legend; empty: not there
  std::vector<double> x, y;
  Style style = Style::kLine;
  std::optional<int> colour = {};  ///< 0 to 6; absent: its place among the curves
};

/// A straight line across the whole chart, with what it means.
struct Rule {
  enum class Direction { kHorizontal, kVertical };
  Direction direction = Direction::kHorizontal;
  double at = 0.0;
  std::string text;
};

/// Curves over a common pair of axes.
struct Chart {
  std::string title;  ///< also what a screen reader says
  Axis x, y;
  std::vector<Curve> curves;
  std::vector<Rule> rules = {};
  double height = 400.0;  ///< of the drawing, which is 640 wide [pixel]
};

/// A plane of cells, each of one kind or of one value.
struct CellMap {
  std::string title;
  Axis x, y;
  std::vector<double> xs, ys;  ///< centres of the cells, ascending
  std::vector<double> values;  ///< xs.size() * ys.size(), x the faster; not finite: left empty
  std::string value_label;     ///< "growth rate [1/s]"
  /// Not empty: values are indices of these kinds ("stands", "falls"), told apart by colour and
  /// pattern; empty: a colour scale centred on zero where the values have both signs.
  std::vector<std::string> kinds = {};
  std::vector<Curve> curves = {};  ///< drawn over the cells
};

/// @return one <svg> element, self-contained, with a viewBox and classes that Page colours
/// @throws Error when the sizes of a chart's vectors do not go together
std::string svg(const Chart& chart);
std::string svg(const CellMap& map);

}  // namespace gyrotwin
