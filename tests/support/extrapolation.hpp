// Gragg-Bulirsch-Stoer extrapolation, order 12, with step control: the tests' own integrator,
// independent of the stepper and made for tolerances close to rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace gyrotwin::reference {

/// The local error of each component stays below absolute + relative * |y_i|.
struct Tolerance {
  double relative = 1e-10;
  double absolute = 1e-12;
};

/// Gragg's modified midpoint rule: n substeps over h; its error has even powers of h/n only.
template <typename Y, typename Rhs>
Y midpoint(const Rhs& rhs, double t, const Y& y, const Y& slope, double h, int n) {
  const double s = h / n;
  Y before = y;
  Y now = y + s * slope;
  for (int i = 1; i < n; ++i) {
    const Y next = before + 2.0 * s * rhs(t + i * s, now);
    before = now;
    now = next;
  }
  return 0.5 * (before + now + s * rhs(t + h, now));
}

/// Integrates y' = rhs(t, y) from t0 to t1 and returns y(t1). `observe(t, y)` is called at t0 and
/// after every accepted step; returning false ends the integration there.
/// @tparam Y an Eigen column vector
/// @throws std::runtime_error when the step becomes too small to advance t
template <typename Y, typename Rhs, typename Observe>
Y integrate(const Rhs& rhs, Y y, double t0, double t1, const Tolerance& tolerance,
            const Observe& observe) {
  constexpr int kColumns = 6;
  double t = t0;
  double h = 1e-3 * (t1 - t0);
  if (!observe(t, y)) return y;
  while (t1 - t > 1e-14 * (t1 - t0)) {
    h = std::min(h, t1 - t);
    if (t + h == t) throw std::runtime_error("integrate: step underflow");
    const Y slope = rhs(t, y);

    // Neville's scheme in (h/n)^2 towards 0: row[m] joins the last m + 1 midpoint results.
    std::array<Y, kColumns> row;
    Y shorter;  // one midpoint result less than row[kColumns - 1]
    for (int k = 0; k < kColumns; ++k) {
      const int n = 2 * (k + 1);
      Y joined = midpoint(rhs, t, y, slope, h, n);
      for (int m = 0; m < k; ++m) {
        const double ratio = static_cast<double>(n) / (n - 2 * (m + 1));
        const Y longer = joined + (joined - row[m]) / (ratio * ratio - 1.0);
        row[m] = joined;
        joined = longer;
      }
      row[k] = joined;
      shorter = k > 0 ? row[k - 1] : joined;
    }
    const Y& next = row[kColumns - 1];

    const double error =
        ((next - shorter).array().abs() /
         (tolerance.absolute + tolerance.relative * y.array().abs().max(next.array().abs())))
            .maxCoeff();
    if (error <= 1.0) {
      t += h;
      y = next;
      if (!observe(t, y)) return y;
    }
    constexpr double kExponent = 1.0 / (2 * kColumns - 1);
    h *= std::clamp(0.9 * std::pow(std::max(error, 1e-20), -kExponent), 0.2, 5.0);
  }
  return y;
}

template <typename Y, typename Rhs>
Y integrate(const Rhs& rhs, const Y& y, double t0, double t1, const Tolerance& tolerance = {}) {
  return integrate(rhs, y, t0, t1, tolerance, [](double, const Y&) { return true; });
}

}  // namespace gyrotwin::reference
