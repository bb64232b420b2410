// Sines and cosines of all coordinates at once. Where the C library chooses by the processor, this
// gives the same bits everywhere.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "services/model/dual.hpp"

namespace gyrotwin::model {

/// sin and cos of n angles [rad], to 0.85 units in the last place up to 10^5 rad; beyond as the C
/// library has them. Source of the polynomials: FreeBSD msun, k_sin.c and k_cos.c.
template <int n>
inline void sine_cosine(const double* angle, double* sine, double* cosine) noexcept {
  constexpr double kLargest = 1e5;
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  // Half pi in three parts; k times each of the first two is exact.
  constexpr double kHalfPi1 = 1.57079632673412561417e+00;
  constexpr double kHalfPi2 = 6.07710050630396597660e-11;
  constexpr double kHalfPi3 = 2.02226624879595063154e-21;
  constexpr double kRound = 0x1.8p52;  // adding it leaves the nearest integer in the last bits

  bool large = false;
  for (int i = 0; i < n; ++i) large |= !(std::abs(angle[i]) < kLargest);
  if (large) {
    for (int i = 0; i < n; ++i) {
      sine[i] = std::sin(angle[i]);
      cosine[i] = std::cos(angle[i]);
    }
    return;
  }

  for (int i = 0; i < n; ++i) {
    const double shifted = angle[i] * kTwoOverPi + kRound;
    const double k = shifted - kRound;
    const double far = angle[i] - k * kHalfPi1;
    const double x = far - k * kHalfPi2;
    const double rest = ((far - x) - k * kHalfPi2) - k * kHalfPi3;  // what x leaves of the angle

    const double z = x * x, xz = x * z;
    const double tail_of_s =
        8.33333333332248946124e-03 +
        z * (-1.98412698298579493134e-04 +
             z * (2.75573137070700676789e-06 +
                  z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    const double s =
        x - ((z * (0.5 * rest - xz * tail_of_s) - rest) + xz * 1.66666666666666324348e-01);
    const double tail_of_c =
        4.16666666666666019037e-02 +
        z * (-1.38888888888741095749e-03 +
             z * (2.48015872894767294178e-05 +
                  z * (-2.75573143513906633035e-07 +
                       z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
    const double half = 0.5 * z, about = 1.0 - half;
    const double c = about + (((1.0 - about) - half) + (z * z * tail_of_c - x * rest));

    // Each quarter turn takes (s, c) to (c, -s).
    const auto quarters = std::bit_cast<std::uint64_t>(shifted);
    const std::uint64_t swap = 0 - (quarters & 1);
    const auto s_bits = std::bit_cast<std::uint64_t>(s), c_bits = std::bit_cast<std::uint64_t>(c);
    const std::uint64_t exchanged = (s_bits ^ c_bits) & swap;
    sine[i] = std::bit_cast<double>((s_bits ^ exchanged) ^ ((quarters & 2) << 62));
    cosine[i] = std::bit_cast<double>((c_bits ^ exchanged) ^ (((quarters + 1) & 2) << 62));
  }
}

/// The same with derivatives.
template <int n>
inline void sine_cosine(const Dual* angle, Dual* sine, Dual* cosine) noexcept {
  double x[n], s[n], c[n];
  for (int i = 0; i < n; ++i) x[i] = angle[i].value;
  sine_cosine<n>(x, s, c);
  for (int i = 0; i < n; ++i) {
    sine[i] = {s[i], angle[i].slope * c[i]};
    cosine[i] = {c[i], -angle[i].slope * s[i]};
  }
}

}  // namespace gyrotwin::model
