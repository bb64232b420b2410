// Gragg-Bulirsch-Stoer extrapolation, order 12, with step control: the tests' own integrator,
// independent of the stepper and made for tolerances close to rounding.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace gyrotwin::reference {

/// Of any size that a machine's state has, without an allocation.
inline constexpr int kMaxSize = 16;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSize, 1>;

/// The local error of each component stays below absolute + relative * |y_i|.
struct Tolerance {
  double relative = 1e-10;
  double absolute = 1e-12;
};

/// dy/dt at (t, y).
using Slope = std::function<SmallVector(double t, const SmallVector& y)>;

/// Integrates y' = slope(t, y) from t0 to t1 and returns y(t1). `observe(t, y)` is called at t0 and
/// after every accepted step; returning false ends the integration there.
/// @throws std::runtime_error when the step becomes too small to advance t
SmallVector integrate(
    const Slope& slope, SmallVector y, double t0, double t1, const Tolerance& tolerance = {},
    const std::function<bool(double t, const SmallVector& y)>& observe =
        [](double, const SmallVector&) { return true; });

}  // namespace gyrotwin::reference
