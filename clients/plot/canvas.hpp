// The frame of a drawing: title, axes, grid, legend; what charts and maps share.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "clients/plot/chart.hpp"
#include "clients/plot/scale.hpp"

namespace gyrotwin {

/// Text with the characters that HTML gives a meaning replaced.
std::string escaped(const std::string& text);

/// One entry of a legend: what stands before the name is drawn by the caller's classes.
struct LegendEntry {
  std::string name;
  std::string sample;  ///< an element of 22 x 10 pixels at the origin
};

/// An SVG under construction. Content is clipped to the axes.
class Canvas {
 public:
  /// @param right pixels kept free beside the axes
  /// @param height of the whole drawing [pixel]
  Canvas(const std::string& title, const Axis& x, const Axis& y, std::span<const double> xs,
         std::span<const double> ys, const std::vector<LegendEntry>& legend, double right = 16.0,
         double height = 400.0);

  const Scale& x() const { return x_; }
  const Scale& y() const { return y_; }
  double left() const { return left_; }
  double right() const { return right_; }
  double top() const { return top_; }
  double bottom() const { return bottom_; }

  /// Inside the axes.
  void draw(const std::string& element) { inside_ += element; }
  /// Anywhere.
  void annotate(const std::string& element) { outside_ += element; }
  /// A curve of one of seven colours.
  void draw_curve(const Curve& curve, int colour);
  std::string svg() const;

 private:
  void draw_axes(const Axis& x, const Axis& y);

  std::string title_;
  double height_;
  double left_, right_, top_, bottom_;
  Scale x_, y_;
  std::string frame_, inside_, outside_;
};

/// What stands for a curve in a legend.
std::string curve_sample(const Curve& curve, int colour);

}  // namespace gyrotwin
