// What a sweep sets: the grammar of its variables, which runs there are, and what many runs say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "clients/sweep/plan.hpp"
#include "clients/sweep/statistics.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

using Texts = std::vector<std::string>;

TEST(Variable, TakesListsAndRanges) {
  EXPECT_EQ(parse_variable("a.b=1,2.50,-3e2").list, (Texts{"1", "2.5", "-300"}));
  EXPECT_EQ(parse_variable("a.b=none,shelf").list, (Texts{"none", "shelf"}));
  EXPECT_EQ(parse_variable("a.b=0:1:5").list, (Texts{"0", "0.25", "0.5", "0.75", "1"}));
  EXPECT_EQ(parse_variable("a.b=3:1:3").list, (Texts{"3", "2", "1"}));
  EXPECT_EQ(parse_variable("a.b=log(1:100:3)").list, (Texts{"1", "10", "100"}));
  // The last value is the one that was given, whatever the rounding on the way.
  EXPECT_EQ(parse_variable("a.b=0.1:0.7:7").list.back(), "0.7");
  const Variable factors = parse_variable("structure.mass_kg=*0.9,1.1");
  EXPECT_TRUE(factors.factor);
  EXPECT_EQ(factors.key, "structure.mass_kg");
  EXPECT_EQ(factors.list, (Texts{"0.9", "1.1"}));
}

TEST(Variable, SaysWhatItExpects) {
  for (const auto& [text, expected] :
       std::vector<std::pair<std::string, std::string>>{{"a.b", "KEY=VALUES"},
                                                        {"=1", "KEY=VALUES"},
                                                        {"a.b=", "A,B,C"},
                                                        {"a.b=1,,2", "A,B,C"},
                                                        {"a.b=*word", "A,B,C"},
                                                        {"a.b=nan,1", "finite numbers"},
                                                        {"a.b=1,-Inf", "finite numbers"},
                                                        {"a.b=0:1", "LOW:HIGH:N"},
                                                        {"a.b=0:1:1", "LOW:HIGH:N"},
                                                        {"a.b=0:1:2.5", "LOW:HIGH:N"},
                                                        {"a.b=1:1:3", "LOW:HIGH:N"},
                                                        {"a.b=0:nan:3", "LOW:HIGH:N"},
                                                        {"a.b=log(0:1:3)", "both above 0"},
                                                        {"a.b=normal(1)", "normal(MEAN,SIGMA)"},
                                                        {"a.b=normal(1,0)", "SIGMA > 0"},
                                                        {"a.b=uniform(2,1)", "LOW < HIGH"},
                                                        {"a.b=gauss(0,1)", "normal(MEAN,SIGMA)"},
                                                        {"a.b=*seed()", "seed()"}}) {
    try {
      parse_variable(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
}

TEST(Variable, DrawsWhatItSays) {
  constexpr int kDraws = 100'000;
  const auto moments = [](const Variable& variable) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = variable.draw(3, 1, i);
      sum += x;
      squares += x * x;
    }
    const double mean = sum / kDraws;
    return std::pair(mean, std::sqrt(squares / kDraws - mean * mean));
  };
  const auto [normal_mean, normal_sigma] = moments(parse_variable("a.b=normal(5,0.5)"));
  EXPECT_NEAR(normal_mean, 5.0, 0.006);  // 4 sigma of the mean, measured 0.0016 off
  EXPECT_NEAR(normal_sigma, 0.5, 0.005);
  const auto [uniform_mean, uniform_sigma] = moments(parse_variable("a.b=uniform(-1,3)"));
  EXPECT_NEAR(uniform_mean, 1.0, 0.015);
  EXPECT_NEAR(uniform_sigma, 4.0 / std::sqrt(12.0), 0.01);
  const Variable seed = parse_variable("a.seed=seed()");
  std::set<double> seeds;
  for (int i = 0; i < 1000; ++i) {
    const double x = seed.draw(0, 0, i);
    EXPECT_EQ(x, std::floor(x));
    EXPECT_GE(x, 0.0);
    EXPECT_LE(x, 999'999.0);
    seeds.insert(x);
  }
  EXPECT_GT(seeds.size(), 990u);
}

TEST(Plan, GoesThroughAllCombinations) {
  Plan plan;
  plan.variables = {parse_variable("a.a=1,2"), parse_variable("a.b=x,y,z")};
  plan.repetitions = 2;
  ASSERT_EQ(plan.runs(), 12);
  EXPECT_EQ(plan.point(0), (Texts{"1", "x"}));
  EXPECT_EQ(plan.point(1), (Texts{"1", "x"}));
  EXPECT_EQ(plan.point(2), (Texts{"1", "y"}));
  EXPECT_EQ(plan.point(6), (Texts{"2", "x"}));
  EXPECT_EQ(plan.point(11), (Texts{"2", "z"}));
}

TEST(Plan, DrawsHangOnSeedVariableAndRunAlone) {
  Plan plan;
  plan.variables = {parse_variable("a.a=normal(0,1)"), parse_variable("a.b=normal(0,1)"),
                    parse_variable("a.c=1,2")};
  plan.repetitions = 50;
  std::set<std::string> seen;
  for (std::int64_t run = 0; run < plan.runs(); ++run) {
    const Point point = plan.point(run);
    EXPECT_EQ(point, plan.point(run));
    seen.insert(point[0]);
    seen.insert(point[1]);
  }
  EXPECT_EQ(seen.size(), 200u);
  Plan other = plan;
  other.seed = 1;
  EXPECT_NE(other.point(0)[0], plan.point(0)[0]);
}

TEST(Plan, RefusesWhatNeverEnds) {
  Plan plan;
  plan.variables = {parse_variable("a.a=0:1:100000"), parse_variable("a.b=0:1:100000")};
  EXPECT_THROW(plan.runs(), Error);
}

/// Values of E. B. Wilson's formula, worked out by hand: 8 of 10, and both ends.
TEST(Statistics, ProportionIsWilsons) {
  const Proportion p = proportion(8, 10);
  EXPECT_DOUBLE_EQ(p.share, 0.8);
  EXPECT_NEAR(p.low, 0.4901625, 1e-6);
  EXPECT_NEAR(p.high, 0.9433178, 1e-6);
  EXPECT_NEAR(proportion(0, 20).high, 0.1611252, 1e-6);
  EXPECT_NEAR(proportion(0, 20).low, 0.0, 1e-12);
  EXPECT_NEAR(proportion(20, 20).low, 1.0 - 0.1611252, 1e-6);
  EXPECT_EQ(proportion(0, 0).low, 0.0);
  EXPECT_EQ(proportion(0, 0).high, 1.0);
}

TEST(Statistics, RankCorrelationSeesOrderAlone) {
  const std::vector<double> x{1, 2, 3, 4, 5};
  EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{1, 8, 27, 64, 125}), 1.0);
  EXPECT_DOUBLE_EQ(rank_correlation(x, std::vector<double>{5, 4, 3, 2, 1}), -1.0);
  EXPECT_TRUE(std::isnan(rank_correlation(x, std::vector<double>{7, 7, 7, 7, 7})));
  // Ties get their mean rank: Pearson's r of ranks (1 2 3 4 5) and (1.5 1.5 4 4 4).
  EXPECT_NEAR(rank_correlation(x, std::vector<double>{0, 0, 1, 1, 1}), std::sqrt(3.0) / 2.0, 1e-12);
}

}  // namespace
}  // namespace gyrotwin
