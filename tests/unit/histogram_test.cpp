#include "services/runtime/histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace gyrotwin {
namespace {

TEST(Histogram, IsEmptyAtFirstAndAfterClear) {
  Histogram histogram;
  EXPECT_EQ(histogram.percentile(50), 0);
  histogram.add(1000);
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.max(), 0);
  EXPECT_EQ(histogram.percentile(0), 0);
  EXPECT_EQ(histogram.percentile(100), 0);
}

TEST(Histogram, NegativeCountsAsZero) {
  Histogram histogram;
  histogram.add(-1);
  histogram.add(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(histogram.count(), 2);
  EXPECT_EQ(histogram.max(), 0);
  EXPECT_EQ(histogram.percentile(100), 0);
}

TEST(Histogram, SmallValuesAreExact) {
  Histogram histogram;
  for (int ns = 1; ns <= 20; ++ns) histogram.add(ns);
  EXPECT_EQ(histogram.percentile(0), 1);
  EXPECT_EQ(histogram.percentile(50), 10);
  EXPECT_EQ(histogram.percentile(51), 11);
  EXPECT_EQ(histogram.percentile(100), 20);
}

// The nearest rank: one value in a hundred is the 99th percentile's limit.
TEST(Histogram, PercentileIsTheNearestRank) {
  Histogram histogram;
  for (int i = 0; i < 99; ++i) histogram.add(3);
  histogram.add(1'000'000);
  EXPECT_EQ(histogram.percentile(99), 3);
  EXPECT_EQ(histogram.percentile(99.1), 1'000'000);
  EXPECT_EQ(histogram.max(), 1'000'000);
}

// Every power of two, one below, one above, and random values of each size: alone in the histogram
// below a far larger one, so that max() does not correct the bucket's end.
TEST(Histogram, EveryValueFallsInABucketOfTheStatedWidth) {
  std::mt19937_64 random(1);
  std::vector<std::int64_t> values;
  for (int bit = 0; bit < 62; ++bit) {
    const std::int64_t power = std::int64_t{1} << bit;
    for (const std::int64_t step : {-1, 0, 1}) values.push_back(power + step);
    for (int i = 0; i < 100; ++i) {
      values.push_back(power +
                       static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(power)));
    }
  }
  double worst = 0;
  for (const std::int64_t value : values) {
    Histogram histogram;
    histogram.add(value);
    histogram.add(std::numeric_limits<std::int64_t>::max());
    const std::int64_t found = histogram.percentile(50);
    ASSERT_GE(found, value);
    if (value > 0) {
      worst = std::max(worst, static_cast<double>(found - value) / static_cast<double>(value));
    }
  }
  EXPECT_LE(worst, Histogram::kRelativeError);  // measured 0.03125
  EXPECT_GT(worst, 0.9 * Histogram::kRelativeError);
}

TEST(Histogram, TakesTheLargestValue) {
  Histogram histogram;
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(histogram.percentile(50), std::numeric_limits<std::int64_t>::max());
}

// Against sorting, on a distribution with the long tail that wake-ups have.
TEST(Histogram, PercentilesAgreeWithSorting) {
  std::mt19937_64 random(2);
  std::lognormal_distribution<double> lateness(11, 1.5);
  Histogram histogram;
  std::vector<std::int64_t> values(10'000);
  for (std::int64_t& value : values) {
    value = std::llround(lateness(random));
    histogram.add(value);
  }
  std::sort(values.begin(), values.end());
  for (const double percent : {0.01, 1.0, 25.0, 50.0, 90.0, 99.0, 99.9, 100.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(percent * 100 - 1e-9));
    const std::int64_t exact = values[rank - 1];
    const std::int64_t found = histogram.percentile(percent);
    EXPECT_GE(found, exact) << percent;
    EXPECT_LE(static_cast<double>(found - exact),
              Histogram::kRelativeError * static_cast<double>(exact))
        << percent;
  }
}

TEST(WindowedHistogram, ShowsTheLastFullWindowOnly) {
  WindowedHistogram window;
  for (int i = 0; i < 98; ++i) window.add(10);
  window.add(20);
  window.add(30);
  EXPECT_EQ(window.max(), 0);

  window.roll();
  window.add(31);
  EXPECT_EQ(window.p50(), 10);
  EXPECT_EQ(window.p99(), 20);
  EXPECT_EQ(window.max(), 30);

  window.roll();
  EXPECT_EQ(window.p50(), 31);
  EXPECT_EQ(window.max(), 31);

  window.roll();
  EXPECT_EQ(window.p99(), 0);
  EXPECT_EQ(window.max(), 0);
}

}  // namespace
}  // namespace gyrotwin
