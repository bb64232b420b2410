// Sines and cosines against those of long doubles.
#include "services/model/sine_cosine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace gyrotwin {
namespace {

using Six = std::array<double, 6>;

/// |found - exact| in units in the last place of the exact one.
double units_off(double found, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  const double unit = std::nextafter(size, INFINITY) - size;
  return static_cast<double>(std::abs(exact - static_cast<long double>(found))) / unit;
}

/// Largest error of sines and cosines of angles within +-range, in units in the last place.
double worst_within(double range) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> angle(-range, range);
  double worst = 0.0;
  for (int i = 0; i < 50'000; ++i) {
    Six x, s, c;
    for (double& each : x) each = angle(engine);
    model::sine_cosine<6>(x.data(), s.data(), c.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto exact = static_cast<long double>(x[k]);
      worst = std::max({worst, units_off(s[k], std::sin(exact)), units_off(c[k], std::cos(exact))});
    }
  }
  return worst;
}

TEST(SineCosine, IsExactButForTheLastPlace) {
  // Measured 0.500, 0.778, 0.771, 0.785; the last with the rounding of the angle's reduction.
  for (const double range : {1e-3, 0.8, 10.0, 1e3}) EXPECT_LT(worst_within(range), 0.8) << range;
  EXPECT_LT(worst_within(1e5), 0.9);  // measured 0.83
}

TEST(SineCosine, IsTheLibrarysBeyondAndWhereThereIsNone) {
  const double infinite = std::numeric_limits<double>::infinity();
  const Six x{1e5, -3e7, 1e300, 0.5, infinite, std::nan("")};
  Six s, c;
  model::sine_cosine<6>(x.data(), s.data(), c.data());
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(s[k], std::sin(x[k]));
    EXPECT_EQ(c[k], std::cos(x[k]));
  }
  for (std::size_t k = 4; k < 6; ++k) {
    EXPECT_TRUE(std::isnan(s[k]));
    EXPECT_TRUE(std::isnan(c[k]));
  }
}

TEST(SineCosine, IsExactAtZeroAndOdd) {
  const Six x{0.0, -0.0, 0.7, -0.7, 2.5, -2.5};
  Six s, c;
  model::sine_cosine<6>(x.data(), s.data(), c.data());
  EXPECT_EQ(s[0], 0.0);
  EXPECT_EQ(c[0], 1.0);
  for (std::size_t k = 0; k < x.size(); k += 2) {
    EXPECT_EQ(s[k + 1], -s[k]);
    EXPECT_EQ(c[k + 1], c[k]);
  }
}

/// An odd number of them, with derivatives: those of others beside them do not matter.
TEST(SineCosine, HasItsDerivatives) {
  const std::array<model::Dual, 3> x{{{0.3, 2.0}, {-1.2, 0.5}, {4.0, -1.0}}};
  std::array<model::Dual, 3> s, c;
  model::sine_cosine<3>(x.data(), s.data(), c.data());
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_LT(units_off(s[k].value, std::sin(static_cast<long double>(x[k].value))), 0.8);
    EXPECT_LT(units_off(c[k].value, std::cos(static_cast<long double>(x[k].value))), 0.8);
    EXPECT_EQ(s[k].slope, x[k].slope * c[k].value);
    EXPECT_EQ(c[k].slope, -x[k].slope * s[k].value);
  }
}

}  // namespace
}  // namespace gyrotwin
