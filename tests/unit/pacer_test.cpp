#include "services/runtime/pacer.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <random>

#include "services/runtime/clock.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // [ns]

/// Sleeps to the deadline and begins the tick, as a daemon's loop does.
bool tick(Pacer& pacer, Clock& clock) {
  clock.sleep_until(pacer.deadline());
  return pacer.begin(clock.now_ns());
}

TEST(Pacer, BeginsOnePeriodAfterTheAnchorAndKeepsTheGrid) {
  FakeClock clock;
  clock.advance(123);
  clock.lateness = 70'000;
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_EQ(pacer.deadline(), 123 + i * kPeriod);
    ASSERT_TRUE(tick(pacer, clock));
  }
  EXPECT_EQ(pacer.overruns(), 0);
  EXPECT_EQ(pacer.skipped_ticks(), 0);
}

TEST(Pacer, RecordsLatenessAndWork) {
  FakeClock clock;
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  for (const std::int64_t lateness : {3, 7, 5}) {
    clock.lateness = lateness;
    tick(pacer, clock);
    pacer.worked(2 * lateness);
  }
  pacer.lateness().roll();
  pacer.compute().roll();
  EXPECT_EQ(pacer.lateness().p50(), 5);
  EXPECT_EQ(pacer.lateness().max(), 7);
  EXPECT_EQ(pacer.compute().p50(), 10);
  EXPECT_EQ(pacer.compute().max(), 14);
}

TEST(Pacer, WakesBeforeTheDeadlineByTheSpin) {
  constexpr std::int64_t kSpin = 200'000;
  FakeClock clock;
  clock.lateness = 67'000;  // less than the spin: no tick is late
  Pacer pacer(kPeriod, OverrunPolicy::kSkip, kSpin);
  pacer.anchor(clock.now_ns());
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_EQ(pacer.wake(), i * kPeriod - kSpin);
    clock.sleep_until(pacer.wake());
    clock.spin_until(pacer.deadline());
    ASSERT_EQ(clock.now_ns(), i * kPeriod);
    ASSERT_TRUE(pacer.begin(clock.now_ns()));
  }
  pacer.lateness().roll();
  EXPECT_EQ(pacer.lateness().max(), 0);
}

TEST(Pacer, SpinsForHalfAWallPeriodAtMost) {
  Pacer pacer(kPeriod, OverrunPolicy::kSkip, 300'000);
  pacer.set_speed(10.0, 0);
  EXPECT_EQ(pacer.deadline(), kPeriod / 10);
  EXPECT_EQ(pacer.wake(), kPeriod / 20);
}

TEST(Pacer, ATickBegunEarlyIsNotLate) {
  Pacer pacer(kPeriod, OverrunPolicy::kStop);
  pacer.anchor(0);
  EXPECT_TRUE(pacer.begin(kPeriod - 10));
  EXPECT_EQ(pacer.deadline(), 2 * kPeriod);
  pacer.lateness().roll();
  EXPECT_EQ(pacer.lateness().max(), 0);
}

TEST(Pacer, OnePeriodLateIsNoOverrunYet) {
  Pacer pacer(kPeriod, OverrunPolicy::kStop);
  pacer.anchor(0);
  EXPECT_TRUE(pacer.begin(2 * kPeriod));
  EXPECT_EQ(pacer.overruns(), 0);
  EXPECT_EQ(pacer.deadline(), 2 * kPeriod);
}

TEST(Pacer, AnOverrunGivesUpThePeriodsGoneBy) {
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.anchor(0);
  EXPECT_TRUE(pacer.begin(2 * kPeriod + 1));
  EXPECT_EQ(pacer.overruns(), 1);
  EXPECT_EQ(pacer.skipped_ticks(), 1);
  EXPECT_EQ(pacer.deadline(), 3 * kPeriod);

  EXPECT_TRUE(pacer.begin(3 * kPeriod + 10 * kPeriod + 5));
  EXPECT_EQ(pacer.overruns(), 2);
  EXPECT_EQ(pacer.skipped_ticks(), 11);
  EXPECT_EQ(pacer.deadline(), 14 * kPeriod);
}

TEST(Pacer, AnOverrunStopsUnderThatPolicyAndStillCounts) {
  Pacer pacer(kPeriod, OverrunPolicy::kStop);
  pacer.anchor(0);
  EXPECT_FALSE(pacer.begin(5 * kPeriod));
  EXPECT_EQ(pacer.overruns(), 1);
  EXPECT_EQ(pacer.skipped_ticks(), 4);
  EXPECT_EQ(pacer.deadline(), 6 * kPeriod);
  EXPECT_TRUE(pacer.begin(6 * kPeriod));
}

TEST(Pacer, AfterAStallTicksDoNotRace) {
  FakeClock clock;
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  tick(pacer, clock);
  clock.advance(50 * kPeriod + kPeriod / 2);
  const std::int64_t stall_end = clock.now_ns();
  tick(pacer, clock);
  EXPECT_EQ(clock.now_ns(), stall_end);
  for (int i = 0; i < 10; ++i) {
    tick(pacer, clock);
    ASSERT_EQ(clock.now_ns(), stall_end + kPeriod / 2 + i * kPeriod);
  }
  EXPECT_EQ(pacer.overruns(), 1);
}

TEST(Pacer, SpeedChangeAndAnchorForgetWhatWasMissed) {
  Pacer pacer(kPeriod, OverrunPolicy::kStop);
  pacer.anchor(0);
  pacer.set_speed(4, 1'000 * kPeriod);
  EXPECT_EQ(pacer.speed(), 4);
  EXPECT_EQ(pacer.deadline(), 1'000 * kPeriod + kPeriod / 4);
  EXPECT_TRUE(pacer.begin(pacer.deadline()));
  EXPECT_EQ(pacer.deadline(), 1'000 * kPeriod + kPeriod / 2);

  pacer.set_speed(0.5, 2'000 * kPeriod);
  EXPECT_TRUE(pacer.begin(pacer.deadline() + 2 * kPeriod));  // one wall period late
  EXPECT_EQ(pacer.deadline(), 2'000 * kPeriod + 4 * kPeriod);

  pacer.anchor(9'000 * kPeriod);
  EXPECT_EQ(pacer.deadline(), 9'002 * kPeriod);
  EXPECT_EQ(pacer.overruns(), 0);
}

TEST(Pacer, AnyPositiveSpeedLeavesTimePassing) {
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.set_speed(1e300, 5);
  EXPECT_EQ(pacer.deadline(), 6);
}

/// A loop under random work, wake-ups, stalls, speed changes and pauses.
class RandomScenario {
 public:
  explicit RandomScenario(unsigned seed)
      : random_(seed),
        policy_(seed % 2 == 0 ? OverrunPolicy::kSkip : OverrunPolicy::kStop),
        pacer_(kPeriod, policy_) {
    anchored();
  }

  void step() {
    switch (below(100)) {
      case 0:
        clock_.advance(below(100 * kPeriod));
        break;
      case 1:
        wall_period_ = kPeriod / (std::int64_t{1} << below(5));
        pacer_.set_speed(static_cast<double>(kPeriod) / static_cast<double>(wall_period_),
                         clock_.now_ns());
        anchored();
        break;
      case 2:
        clock_.advance(below(10 * kPeriod));
        pacer_.anchor(clock_.now_ns());
        anchored();
        break;
      default:
        one_tick();
    }
  }

  std::int64_t overruns() const { return pacer_.overruns(); }

 private:
  std::int64_t below(std::int64_t limit) {
    return static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(limit));
  }

  void anchored() {
    pacer_.anchor(clock_.now_ns());
    ASSERT_EQ(pacer_.deadline(), clock_.now_ns() + wall_period_);
    anchor_ = clock_.now_ns();
    ticks_ = 0;
    skipped_before_ = pacer_.skipped_ticks();
  }

  void one_tick() {
    clock_.lateness = below(wall_period_ / 8);
    clock_.sleep_until(pacer_.deadline());
    const std::int64_t begun = clock_.now_ns();
    const std::int64_t due = pacer_.deadline();
    const std::int64_t overruns_before = pacer_.overruns();
    const bool go_on = pacer_.begin(begun);
    ++ticks_;

    const bool overrun = begun - due > wall_period_;
    ASSERT_EQ(pacer_.overruns() - overruns_before, overrun ? 1 : 0);
    ASSERT_EQ(go_on, !(overrun && policy_ == OverrunPolicy::kStop));

    // Deadlines strictly increase, on the anchor's grid, and every place on it is a tick or
    // counted.
    ASSERT_GT(pacer_.deadline(), due);
    ASSERT_EQ(pacer_.deadline() - anchor_,
              (ticks_ + pacer_.skipped_ticks() - skipped_before_ + 1) * wall_period_);
    // A late tick leaves at most one place on the grid to catch up, an overrun none.
    ASSERT_GE(pacer_.deadline(), overrun ? begun + 1 : begun);
    ASSERT_LE(pacer_.deadline(), begun + wall_period_);
    // So no window of n wall periods holds more than n + 2 ticks.
    recent_.push_back(begun);
    if (recent_.size() > 4) recent_.pop_front();
    if (recent_.size() == 4 && ticks_ >= 4) {
      ASSERT_GE(recent_.back() - recent_.front(), wall_period_);
    }

    clock_.advance(below(wall_period_));
  }

  std::mt19937_64 random_;
  OverrunPolicy policy_;
  FakeClock clock_;
  Pacer pacer_;
  std::int64_t wall_period_ = kPeriod;
  std::int64_t anchor_ = 0;
  std::int64_t ticks_ = 0;  ///< since the anchor
  std::int64_t skipped_before_ = 0;
  std::deque<std::int64_t> recent_;  ///< when the last ticks began
};

TEST(Pacer, HoldsItsPromisesInRandomScenarios) {
  std::int64_t overruns = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomScenario scenario(seed);
    for (int i = 0; i < 1000 && !::testing::Test::HasFatalFailure(); ++i) scenario.step();
    ASSERT_FALSE(::testing::Test::HasFatalFailure()) << "seed " << seed;
    overruns += scenario.overruns();
  }
  EXPECT_GT(overruns, 100);  // measured 991: the scenarios do meet overruns
}

}  // namespace
}  // namespace gyrotwin
