// A long curve in little memory, with all its peaks.
#pragma once

#include <cstddef>
#include <vector>

namespace gyrotwin {

/// Takes points of ascending x and keeps, of stretches of equal width, the first, lowest, highest
/// and last. The stretches become wider as the curve becomes longer.
class Envelope {
 public:
  /// @param stretches the most that are kept, above 1; half as many at least once there were more
  explicit Envelope(std::size_t stretches) : most_(stretches) {}

  /// @param y not finite: the curve is interrupted here
  void add(double x, double y);

  /// Whether all there was is 0.
  bool is_zero() const;

  struct Points {
    std::vector<double> x, y;
  };
  /// What was kept, in the order it came; nan where the curve is interrupted.
  Points points() const;

 private:
  struct Point {
    double x, y;
  };
  struct Stretch {
    std::size_t index;
    Point first, low, high, last;
    bool ends = false;  // the curve is interrupted behind it
  };
  static void join(Stretch& to, const Stretch& behind);
  void widen();

  std::size_t most_;
  double begin_ = 0.0, width_ = 1e-3;
  std::vector<Stretch> stretches_;
};

}  // namespace gyrotwin
