// The random numbers of sensors and gusts: their distribution, and that no two are related.
#include "services/onboard/noise.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "services/integrator/dryden.hpp"

namespace gyrotwin {
namespace {

constexpr std::uint64_t kDraws = 1'000'000;

TEST(Normal, HasTheMomentsOfTheNormalDistribution) {
  std::array<double, 5> moment{};
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = normal(1, 2, i);
    for (int k = 1; k <= 4; ++k) moment[k] += std::pow(x, k) / kDraws;
  }
  // Five standard errors of a million draws each.
  EXPECT_NEAR(moment[1], 0.0, 5e-3);                    // measured 3.4e-4
  EXPECT_NEAR(moment[2], 1.0, 5e-3 * M_SQRT2);          // measured 1 - 1.3e-3
  EXPECT_NEAR(moment[3], 0.0, 5e-3 * std::sqrt(15.0));  // measured 2.3e-3
  EXPECT_NEAR(moment[4], 3.0, 5e-3 * std::sqrt(96.0));  // measured 3 - 9.8e-3
}

TEST(Normal, HasItsTails) {
  std::array<std::uint64_t, 5> beyond{};
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = std::abs(normal(3, 0, i));
    for (int k = 1; k <= 4; ++k) beyond[k] += x > k;
  }
  for (int k = 1; k <= 4; ++k) {
    const double expected = kDraws * std::erfc(k / M_SQRT2);
    // Measured: 0.3, 0.4, 0.1 and 1.6 standard errors.
    EXPECT_NEAR(static_cast<double>(beyond[k]), expected, 5.0 * std::sqrt(expected)) << k;
  }
}

TEST(Normal, NeighboursAreIndependent) {
  // Products of draws that differ in one number, and of their squares.
  struct Sum {
    double product = 0.0, squares = 0.0;
    void add(double x, double y) {
      product += x * y / kDraws;
      squares += (x * x - 1.0) * (y * y - 1.0) / (2.0 * kDraws);
    }
  };
  Sum index, stream, seed, swapped;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = normal(7, 5, i);
    index.add(x, normal(7, 5, i + 1));
    stream.add(x, normal(7, 6, i));
    seed.add(x, normal(8, 5, i));
    swapped.add(x, normal(5, 7, i));
  }
  for (const Sum& sum : {index, stream, seed, swapped}) {
    EXPECT_NEAR(sum.product, 0.0, 5e-3);  // measured 1.2e-3
    EXPECT_NEAR(sum.squares, 0.0, 5e-3);  // measured 1.5e-3
  }
}

TEST(Normal, IsAFunctionOfItsThreeNumbers) {
  EXPECT_EQ(normal(1, 2, 3), normal(1, 2, 3));
  EXPECT_NE(normal(1, 2, 3), normal(1, 2, 4));
  EXPECT_NE(normal(1, 2, 3), normal(1, 3, 2));
  EXPECT_NE(normal(1, 2, 3), normal(2, 1, 3));
}

// Many runs of a process side by side: its mean square at each sample, and how it has to do with
// the first one.
template <class Process>
struct Ensemble {
  static constexpr int kRuns = 40'000;
  static constexpr int kSamples = 41;
  std::array<double, kSamples> variance{}, with_first{};

  explicit Ensemble(double step) {
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      Process process(step, 1.0);
      double first = 0.0;
      for (int k = 0; k < kSamples; ++k) {
        const double x = process.next({run, 0}, static_cast<std::uint64_t>(k));
        if (k == 0) first = x;
        variance[static_cast<std::size_t>(k)] += x * x / kRuns;
        with_first[static_cast<std::size_t>(k)] += x * first / kRuns;
      }
    }
  }
};

double along(double t) { return std::exp(-t); }
double across(double t) { return (1.0 - 0.5 * t) * std::exp(-t); }

// Steps far below, near and above the correlation time 1.
class Dryden : public testing::TestWithParam<double> {};

template <class Process>
void expect_theory(double step, double (*autocorrelation)(double)) {
  const Ensemble<Process> ensemble(step);
  // A mean square of 40,000 runs has a standard error of 0.0071, a product one of 0.0050 to 0.0071.
  for (std::size_t k = 0; k < ensemble.variance.size(); ++k) {
    const double expected = autocorrelation(static_cast<double>(k) * step);
    EXPECT_NEAR(ensemble.variance[k], 1.0, 0.036) << "sample " << k;      // measured 0.018
    EXPECT_NEAR(ensemble.with_first[k], expected, 0.036) << "lag " << k;  // measured 0.012
  }
}

TEST_P(Dryden, AlongTheWindIsStationaryAndDecays) { expect_theory<DrydenAlong>(GetParam(), along); }

TEST_P(Dryden, AcrossTheWindIsStationaryAndSwingsBack) {
  expect_theory<DrydenAcross>(GetParam(), across);
}

INSTANTIATE_TEST_SUITE_P(Steps, Dryden, testing::Values(1e-6, 0.1, 2.0));

TEST(Dryden, SpectraAreThoseOfTheSpecification) {
  // Mean periodogram of many runs, at frequencies below the aliases' reach.
  constexpr int kRuns = 2000, kSamples = 1000;
  constexpr double kStep = 0.1;
  const auto mean_periodogram = [&]<class Process>(Process, double w) {
    double sum = 0.0;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      Process process(kStep, 1.0);
      double re = 0.0, im = 0.0;
      for (int k = 0; k < kSamples; ++k) {
        const double x = process.next({run, 9}, static_cast<std::uint64_t>(k));
        re += x * std::cos(w * kStep * k);
        im += x * std::sin(w * kStep * k);
      }
      sum += (re * re + im * im) * kStep / kSamples / kRuns;
    }
    return sum;
  };
  for (const double cycles : {2.0, 8.0, 20.0, 40.0}) {  // per run of 100 correlation times
    const double w = 2.0 * M_PI * cycles / (kSamples * kStep);
    const double w2 = w * w;
    const double S_along = 2.0 / (1.0 + w2);
    const double S_across = (1.0 + 3.0 * w2) / ((1.0 + w2) * (1.0 + w2));
    const double a = mean_periodogram(DrydenAlong(), w) / S_along;
    const double b = mean_periodogram(DrydenAcross(), w) / S_across;
    // A periodogram has the standard error of its mean, 2.2 % of it for 2000 runs; the window adds
    // some 3 %.
    EXPECT_NEAR(a, 1.0, 0.14) << w;  // measured 0.053
    EXPECT_NEAR(b, 1.0, 0.14) << w;  // measured 0.055
  }
}

}  // namespace
}  // namespace gyrotwin
