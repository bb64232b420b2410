#include "tests/support/extrapolation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace gyrotwin::reference {

namespace {

constexpr int kColumns = 6;

/// Gragg's modified midpoint rule: n substeps over h; its error has even powers of h/n only.
SmallVector midpoint(const Slope& slope, double t, const SmallVector& y, const SmallVector& first,
                     double h, int n) {
  const double s = h / n;
  SmallVector before = y;
  SmallVector now = y + s * first;
  for (int i = 1; i < n; ++i) {
    const SmallVector next = before + 2.0 * s * slope(t + i * s, now);
    before = now;
    now = next;
  }
  return 0.5 * (before + now + s * slope(t + h, now));
}

}  // namespace

SmallVector integrate(const Slope& slope, SmallVector y, double t0, double t1,
                      const Tolerance& tolerance,
                      const std::function<bool(double t, const SmallVector& y)>& observe) {
  double t = t0;
  double h = 1e-3 * (t1 - t0);
  if (!observe(t, y)) return y;
  while (t1 - t > 1e-14 * (t1 - t0)) {
    h = std::min(h, t1 - t);
    if (t + h == t) throw std::runtime_error("integrate: step underflow");
    const SmallVector first = slope(t, y);

    // Neville's scheme in (h/n)^2 towards 0: row[m] joins the last m + 1 midpoint results.
    std::array<SmallVector, kColumns> row;
    SmallVector shorter;  // one midpoint result less than row[kColumns - 1]
    for (int k = 0; k < kColumns; ++k) {
      const int n = 2 * (k + 1);
      SmallVector joined = midpoint(slope, t, y, first, h, n);
      for (int m = 0; m < k; ++m) {
        const double ratio = static_cast<double>(n) / (n - 2 * (m + 1));
        const SmallVector longer = joined + (joined - row[m]) / (ratio * ratio - 1.0);
        row[m] = joined;
        joined = longer;
      }
      row[k] = joined;
      shorter = k > 0 ? row[k - 1] : joined;
    }
    const SmallVector& next = row[kColumns - 1];

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

}  // namespace gyrotwin::reference
