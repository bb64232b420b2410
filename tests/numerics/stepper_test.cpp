// The steppers: order, exactness, bounded work, what is carried over between calls.
#include "services/integrator/stepper.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "services/integrator/kutta.hpp"
#include "services/integrator/plant.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

/// y'' = -y + sin(t / 2), y(0) = 1, y'(0) = 0: y = cos t - (2/3) sin t + (4/3) sin(t / 2).
class Oscillator : public Ode {
 public:
  int size() const noexcept override { return 2; }
  void rates(double t, const double* y, double* dy) noexcept override {
    dy[0] = y[1];
    dy[1] = -y[0] + std::sin(0.5 * t);
  }
  static double exact(double t) {
    return std::cos(t) - 2.0 / 3.0 * std::sin(t) + 4.0 / 3.0 * std::sin(0.5 * t);
  }
};

double error_at_10(const StepPolicy& policy, int calls) {
  Oscillator ode;
  Stepper stepper(ode, policy);
  std::array<double, 2> y{1.0, 0.0};
  for (int i = 0; i < calls; ++i) {
    EXPECT_TRUE(stepper.advance(10.0 * i / calls, 10.0 * (i + 1) / calls, y));
  }
  return std::abs(y[0] - Oscillator::exact(10.0));
}

TEST(Stepper, FixedStepsConvergeWithOrderFive) {
  double coarse = error_at_10({.substeps = 1}, 40);
  for (const int substeps : {2, 4, 8}) {
    const double fine = error_at_10({.substeps = substeps}, 40);
    EXPECT_GT(std::log2(coarse / fine), 4.5) << substeps;  // measured 5.0 to 5.3
    coarse = fine;
  }
  EXPECT_LT(coarse, 1e-9);  // measured 2e-11
}

TEST(Stepper, AdaptiveStepsKeepTheirTolerance) {
  EXPECT_LT(error_at_10({StepPolicy::Kind::kAdaptive}, 1), 1e-11);   // measured 1e-12
  EXPECT_LT(error_at_10({StepPolicy::Kind::kAdaptive}, 37), 1e-11);  // measured 1e-12
}

TEST(Stepper, QuickStepsKeepTheirTolerance) {
  const double error = error_at_10({StepPolicy::Kind::kQuick}, 1);
  EXPECT_LT(error, 1e-5);  // measured 2e-6, of some 460 steps
  EXPECT_GT(error, 1e-9);  // or they are not quick
  EXPECT_LT(error_at_10({StepPolicy::Kind::kQuick}, 1000), 1e-5);
}

TEST(Stepper, QuickStepsBeginAsTheyEnded) {
  Oscillator ode;
  Stepper stepper(ode, {StepPolicy::Kind::kQuick});
  std::array<double, 2> y{1.0, 0.0};
  stepper.advance(0.0, 1.0, y);
  const std::int64_t first = stepper.evaluations();
  EXPECT_GT(first, 3 * 10);
  stepper.advance(1.0, 1.001, y);  // far less than a step
  EXPECT_EQ(stepper.evaluations(), 3);
  stepper.advance(1.001, 1.05, y);
  EXPECT_EQ(stepper.evaluations(), 3 * 3);  // with a first step of any length: 11
}

TEST(Kutta, IsOfThirdOrderAndKeepsItsTolerance) {
  struct Done {
    double error;
    std::int64_t evaluations;
  };
  const auto done = [](double tolerance) {
    Oscillator ode;
    Kutta<4> pair(ode, tolerance);
    std::array<double, 2> y{1.0, 0.0};
    EXPECT_TRUE(pair.advance(0.0, 10.0, y.data()));
    return Done{std::abs(y[0] - Oscillator::exact(10.0)), pair.evaluations()};
  };
  Done coarse = done(1e-4);
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const Done fine = done(tolerance);
    const double cost = static_cast<double>(fine.evaluations) / coarse.evaluations;
    EXPECT_NEAR(std::log10(cost), 2.0 / 3.0, 0.07);                 // measured 0.64 to 0.67
    EXPECT_NEAR(std::log10(coarse.error / fine.error), 2.0, 0.15);  // measured 2.00 to 2.08
    coarse = fine;
  }
}

/// y' = 0, and 1 from `at` on.
class Kink : public Ode {
 public:
  explicit Kink(double at) : at_(at) {}
  int size() const noexcept override { return 1; }
  void rates(double t, const double*, double* dy) noexcept override { dy[0] = t < at_ ? 0.0 : 1.0; }

 private:
  double at_;
};

TEST(Stepper, StepsMeetAJumpOfTheRates) {
  for (const auto& [kind, error] :
       {std::pair{StepPolicy::Kind::kAdaptive, 1e-9}, std::pair{StepPolicy::Kind::kQuick, 1e-6}}) {
    Kink ode(0.3);
    Stepper stepper(ode, {kind});
    std::array<double, 1> y{0.0};
    EXPECT_TRUE(stepper.advance(0.0, 1.0, y));
    EXPECT_NEAR(y[0], 0.7, error);
    EXPECT_LT(stepper.evaluations(), 2000);
  }
}

/// A jump within a quick step of length h is off by h / 3 at most, and estimated at h / 48.
TEST(Stepper, QuickStepsAreOffBySixteenTolerancesAtAJumpAtMost) {
  constexpr double kMost = 16.0 * StepPolicy::kCoarse;
  for (int i = 1; i < 100; ++i) {
    Kink ode(0.01 * i);
    Stepper stepper(ode, {StepPolicy::Kind::kQuick});
    std::array<double, 1> y{0.0};
    EXPECT_TRUE(stepper.advance(0.0, 1.0, y));
    EXPECT_NEAR(y[0], 1.0 - 0.01 * i, kMost) << i;  // measured 3.05056e-06
  }
}

TEST(Stepper, QuickStepsTakeNoInfiniteEntry) {
  Oscillator ode;
  Stepper stepper(ode, {StepPolicy::Kind::kQuick});
  std::array<double, 2> y{HUGE_VAL, 1.0};
  EXPECT_FALSE(stepper.advance(0.0, 0.1, y));
}

TEST(Stepper, WhatGoesToAndFroIsGivenUp) {
  struct Chatter : Ode {
    int size() const noexcept override { return 1; }
    void rates(double, const double* y, double* dy) noexcept override {
      dy[0] = y[0] > 0.0 ? -1e6 : 1e6;
    }
  } ode;
  Stepper stepper(ode, {StepPolicy::Kind::kQuick});
  std::array<double, 1> y{0.5};
  EXPECT_FALSE(stepper.advance(0.0, 1.0, y));
  EXPECT_LE(stepper.evaluations(), 300'001);
}

TEST(Stepper, WorkOfAFixedCallIsBounded) {
  Oscillator ode;
  Stepper stepper(ode, {.substeps = 4});
  std::array<double, 2> y{1.0, 0.0};
  for (int i = 0; i < 100; ++i) {
    stepper.advance(0.0, 0.1, y);
    EXPECT_LE(stepper.evaluations(), 6 * 4 + 1);
  }
}

TEST(Stepper, ACallDependsOnNothingButItsArguments) {
  Oscillator ode;
  Stepper used(ode, {.substeps = 3}), fresh(ode, {.substeps = 3});
  std::array<double, 2> y{5.0, -3.0};
  for (int i = 0; i < 10; ++i) used.advance(i, i + 1, y);
  std::array<double, 2> a{0.3, 0.4}, b{0.3, 0.4};
  used.advance(2.0, 2.1, a);
  fresh.advance(2.0, 2.1, b);
  EXPECT_EQ(a, b);
}

TEST(Stepper, FailureIsSaidAndCanBeRecoveredFrom) {
  struct Explosion : Ode {
    int size() const noexcept override { return 1; }
    void rates(double, const double* y, double* dy) noexcept override { dy[0] = y[0] * y[0]; }
  } ode;  // y = 1 / (1 - t) from y(0) = 1
  Stepper adaptive(ode, {StepPolicy::Kind::kAdaptive}), quick(ode, {StepPolicy::Kind::kQuick});
  for (Stepper* stepper : {&adaptive, &quick}) {
    std::array<double, 1> y{1.0};
    EXPECT_FALSE(stepper->advance(0.0, 2.0, y));
    y = {1.0};
    EXPECT_TRUE(stepper->advance(0.0, 0.5, y));
    EXPECT_NEAR(y[0], 2.0, stepper == &quick ? 1e-5 : 1e-10);  // measured 1e-6, 2e-12
    y = {NAN};
    EXPECT_FALSE(stepper->advance(0.0, 0.5, y));
  }
}

TEST(Stepper, DoesNotAllocate) {
  Oscillator ode;
  Stepper fixed(ode, {.substeps = 4}), adaptive(ode, {StepPolicy::Kind::kAdaptive});
  Stepper quick(ode, {StepPolicy::Kind::kQuick});
  std::array<double, 2> y{1.0, 0.0};
  fixed.advance(0.0, 0.1, y);
  adaptive.advance(0.0, 0.1, y);
  const AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    fixed.advance(0.0, 0.1, y);
    adaptive.advance(0.0, 0.1, y);
    quick.advance(0.0, 0.1, y);
  }
  EXPECT_EQ(allocations.count(), 0);
}

class RigStepping : public testing::TestWithParam<const char*> {};

TEST_P(RigStepping, MeetsTheRigsOwnTolerance) {
  const Rig rig = load_rig(GetParam());
  const model::Machine machine = rig.build_machine();
  const double error = stepping_error(rig, machine);
  EXPECT_LT(error, rig.loop.step_tolerance);
  RecordProperty("error_rad", std::to_string(error));
  // The check can fail: a tolerance below what the steps give must be noticed.
  EXPECT_GT(error, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(Rigs, RigStepping,
                         testing::Values("prototype_a", "prototype_b", "prototype_b_sleeping",
                                         "gooch", "townsend", "double_brennan", "brennan_monorail",
                                         "gyrocar"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace gyrotwin
