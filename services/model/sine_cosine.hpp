// Sines and cosines of all coordinates at once. Where the C library chooses by the processor, this
// gives the same bits everywhere. Static, as what calls it: evaluate.hpp.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "services/model/dual.hpp"

namespace gyrotwin::model {

/// Two at a time, which every x86-64 and ARMv8 can.
using Pair = double __attribute__((vector_size(16)));
using PairOfBits = std::int64_t __attribute__((vector_size(16)));

/// How many numbers n take in pairs.
constexpr int in_pairs(int n) { return n + n % 2; }

/// Of two angles up to 10^5 rad. Source of the polynomials: FreeBSD msun, k_sin.c and k_cos.c.
static inline void sine_cosine(Pair angle, Pair& sine, Pair& cosine) noexcept {
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  // Half pi in three parts; k times each of the first two is exact.
  constexpr double kHalfPi1 = 1.57079632673412561417e+00;
  constexpr double kHalfPi2 = 6.07710050630396597660e-11;
  constexpr double kHalfPi3 = 2.02226624879595063154e-21;
  constexpr double kRound = 0x1.8p52;  // adding it leaves the nearest integer in the last bits

  const Pair shifted = angle * kTwoOverPi + kRound;
  const Pair k = shifted - kRound;
  const Pair far = angle - k * kHalfPi1;
  const Pair x = far - k * kHalfPi2;
  const Pair rest = ((far - x) - k * kHalfPi2) - k * kHalfPi3;  // what x leaves of the angle

  const Pair z = x * x, xz = x * z;
  const Pair tail_of_s =
      8.33333333332248946124e-03 +
      z * (-1.98412698298579493134e-04 +
           z * (2.75573137070700676789e-06 +
                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const Pair s = x - ((z * (0.5 * rest - xz * tail_of_s) - rest) + xz * 1.66666666666666324348e-01);
  const Pair tail_of_c =
      4.16666666666666019037e-02 +
      z * (-1.38888888888741095749e-03 +
           z * (2.48015872894767294178e-05 +
                z * (-2.75573143513906633035e-07 +
                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  const Pair half = 0.5 * z, about = 1.0 - half;
  const Pair c = about + (((1.0 - about) - half) + (z * z * tail_of_c - x * rest));

  // Each quarter turn takes (s, c) to (c, -s).
  const auto quarters = reinterpret_cast<PairOfBits>(shifted);
  const PairOfBits swap = -(quarters & 1);
  const auto s_bits = reinterpret_cast<PairOfBits>(s), c_bits = reinterpret_cast<PairOfBits>(c);
  const PairOfBits exchanged = (s_bits ^ c_bits) & swap;
  sine = reinterpret_cast<Pair>(s_bits ^ exchanged ^ ((quarters & 2) << 62));
  cosine = reinterpret_cast<Pair>(c_bits ^ exchanged ^ (((quarters + 1) & 2) << 62));
}

/// sin and cos of n angles [rad], to 0.85 units in the last place up to 10^5 rad; beyond as the C
/// library has them. The arrays hold in_pairs(n) numbers.
template <int n>
static void sine_cosine(const double* angle, double* sine, double* cosine) noexcept {
  constexpr double kLargest = 1e5;
  bool large = false;
  for (int i = 0; i < n; ++i) large |= !(std::abs(angle[i]) < kLargest);
  if (large) {
    for (int i = 0; i < n; ++i) {
      sine[i] = std::sin(angle[i]);
      cosine[i] = std::cos(angle[i]);
    }
    return;
  }
  for (int i = 0; i < n; i += 2) {
    Pair s, c;
    sine_cosine(Pair{angle[i], angle[i + 1]}, s, c);
    std::memcpy(sine + i, &s, sizeof s);
    std::memcpy(cosine + i, &c, sizeof c);
  }
}

/// The same with derivatives.
template <int n>
static void sine_cosine(const Dual* angle, Dual* sine, Dual* cosine) noexcept {
  double x[in_pairs(n)] = {}, s[in_pairs(n)], c[in_pairs(n)];
  for (int i = 0; i < n; ++i) x[i] = angle[i].value;
  sine_cosine<n>(x, s, c);
  for (int i = 0; i < n; ++i) {
    sine[i] = {s[i], angle[i].slope * c[i]};
    cosine[i] = {c[i], -angle[i].slope * s[i]};
  }
}

}  // namespace gyrotwin::model
