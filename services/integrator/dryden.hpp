// Turbulence along a path through frozen air, by Dryden's spectra as MIL-F-8785C writes them. With
// the correlation time T = L / V of a scale length L [m] passed at V [m/s]:
//   along the wind   S(w) ~ 1 / (1 + (T w)^2),                        R(t) = exp(-t / T)
//   across the wind  S(w) ~ (1 + 3 (T w)^2) / (1 + (T w)^2)^2,        R(t) = (1 - t / 2T) exp(-t /
//   T)
// Sampled exactly: at the sampling instants the discrete processes have these autocorrelations R,
// variance 1, from the first sample on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "services/onboard/noise.hpp"

namespace gyrotwin {

/// Where a process has its random numbers from; one that needs two takes the next stream as well.
struct NoiseSource {
  std::uint64_t seed;
  std::uint64_t stream;
};

/// x' = -x / T + white noise: along the wind, and any gust of a correlation time.
class DrydenAlong {
 public:
  DrydenAlong() = default;
  /// @param step between samples [s]; @param correlation T [s]
  DrydenAlong(double step, double correlation)
      : kept_(std::exp(-step / correlation)),
        fresh_(std::sqrt(-std::expm1(-2.0 * step / correlation))) {}

  /// Sample number `index`; to be called with 0, 1, 2, ...
  double next(const NoiseSource& source, std::uint64_t index) noexcept {
    const double w = normal(source.seed, source.stream, index);
    x_ = index == 0 ? w : kept_ * x_ + fresh_ * w;
    return x_;
  }

 private:
  double kept_ = 0.0, fresh_ = 1.0;
  double x_ = 0.0;
};

/// (1 + sqrt(3) T s) / (1 + T s)^2 of white noise. In units of T: x' = -x + noise, y' = -y + x, and
/// the output sqrt(3) x + (1 - sqrt(3)) y.
class DrydenAcross {
 public:
  DrydenAcross() = default;
  /// @param step between samples [s]; @param correlation T [s]
  DrydenAcross(double step, double correlation) : h_(step / correlation), kept_(std::exp(-h_)) {
    // Covariance of what the noise adds in one step, and its Cholesky factor.
    const double kept2 = kept_ * kept_;
    const double xx = -0.5 * std::expm1(-2.0 * h_);
    const double xy = 0.25 * (1.0 - kept2 * (1.0 + 2.0 * h_));
    const double yy = 0.25 * (1.0 - kept2 * (1.0 + 2.0 * h_ + 2.0 * h_ * h_));
    xx_ = std::sqrt(xx);
    yx_ = xy / xx_;
    yy_ = std::sqrt(std::max(0.0, yy - yx_ * yx_));  // h^3 / 12, which rounding may swallow
  }

  /// Sample number `index`; to be called with 0, 1, 2, ...
  double next(const NoiseSource& source, std::uint64_t index) noexcept {
    const double w1 = normal(source.seed, source.stream, index);
    const double w2 = normal(source.seed, source.stream + 1, index);
    if (index == 0) {  // stationary: variances 1/2 and 1/4, covariance 1/4
      x_ = std::numbers::sqrt2 / 2.0 * w1;
      y_ = std::numbers::sqrt2 / 4.0 * (w1 + w2);
    } else {
      y_ = kept_ * (y_ + h_ * x_) + yx_ * w1 + yy_ * w2;
      x_ = kept_ * x_ + xx_ * w1;
    }
    return std::numbers::sqrt3 * x_ + (1.0 - std::numbers::sqrt3) * y_;
  }

 private:
  double h_ = 0.0, kept_ = 0.0;
  double xx_ = 0.0, yx_ = 0.0, yy_ = 0.0;
  double x_ = 0.0, y_ = 0.0;
};

}  // namespace gyrotwin
