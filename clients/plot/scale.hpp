// From values to pixels, and where to put ticks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "clients/plot/chart.hpp"

namespace gyrotwin {

/// One axis of a drawing.
class Scale {
 public:
  /// @param data what is to be seen; what is not finite (or, on a logarithmic axis, not positive)
  ///        counts for nothing; limits of the axis come first
  /// @param first, last pixels of the axis' low and high end
  Scale(const Axis& axis, std::span<const double> data, double first, double last);

  double low() const { return low_; }
  double high() const { return high_; }
  /// Not finite where the value has no place.
  double pixel(double value) const;
  bool shows(double value) const { return value >= low_ && value <= high_; }

  /// Values at distances of 1, 2 or 5 times a power of ten (logarithmic: at powers of ten), about
  /// `wanted` of them.
  std::vector<double> ticks(int wanted) const;

 private:
  bool logarithmic_;
  double low_, high_;
  double first_, last_;
};

/// A tick's number, no digit more than its neighbours need.
std::string tick_label(double value, double step);

}  // namespace gyrotwin
