// What came and what did not, and which rates a line is good for.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "clients/netcheck/arrivals.hpp"
#include "clients/netcheck/verdict.hpp"
#include "tests/support/measurement.hpp"

namespace gyrotwin::netcheck {
namespace {

TEST(Arrivals, TellsNewRepeatedAndLate) {
  Arrivals arrivals;
  for (const std::int64_t n : {0, 1, 1, 5, 3, 3, 6}) arrivals.hear(n);
  EXPECT_EQ(arrivals.distinct(), 5);
  EXPECT_EQ(arrivals.repeats(), 2);
  EXPECT_EQ(arrivals.late(), 1);
}

TEST(Arrivals, CountsTheFirstOnesToo) {
  Arrivals arrivals;
  EXPECT_TRUE(arrivals.hear(2));
  EXPECT_TRUE(arrivals.hear(0));
  EXPECT_FALSE(arrivals.hear(0));
}

TEST(Arrivals, RemembersAWindowOfNumbers) {
  constexpr std::int64_t kWindow = Arrivals::kWindow;
  Arrivals arrivals;
  arrivals.hear(0);
  arrivals.hear(kWindow);
  EXPECT_TRUE(arrivals.hear(1)) << "the last that is remembered not to have come";
  EXPECT_FALSE(arrivals.hear(0)) << "too long ago to be told from a repeat";
  EXPECT_TRUE(arrivals.hear(std::numeric_limits<std::int64_t>::max()));
  EXPECT_TRUE(arrivals.hear(std::numeric_limits<std::int64_t>::max() - kWindow + 1));
  EXPECT_FALSE(arrivals.hear(kWindow));
}

TEST(Arrivals, MayBeginAtTheLargestNumber) {
  Arrivals arrivals;
  EXPECT_TRUE(arrivals.hear(std::numeric_limits<std::int64_t>::max()));
  EXPECT_FALSE(arrivals.hear(std::numeric_limits<std::int64_t>::max()));
  EXPECT_TRUE(arrivals.hear(std::numeric_limits<std::int64_t>::max() - 1));
  EXPECT_FALSE(arrivals.hear(0)) << "too long ago to be told from a repeat";
  EXPECT_EQ(arrivals.distinct(), 2);
}

// Against a set, numbers in disorder that go round the window several times.
TEST(Arrivals, AgreesWithASet) {
  std::mt19937 random(1);
  Arrivals arrivals;
  std::vector<bool> came(400'000, false);
  std::int64_t distinct = 0, repeats = 0;
  for (std::int64_t n = 0; n < 300'000; ++n) {
    const std::int64_t number =
        std::max<std::int64_t>(0, n - static_cast<std::int64_t>(random() % 60'000));
    const bool is_new = !came[static_cast<std::size_t>(number)];
    came[static_cast<std::size_t>(number)] = true;
    ASSERT_EQ(arrivals.hear(number), is_new) << n;
    ++(is_new ? distinct : repeats);
  }
  EXPECT_EQ(arrivals.distinct(), distinct);
  EXPECT_EQ(arrivals.repeats(), repeats);
}

TEST(Trip, TakesTheOthersTurnOutOfTheRoundTrip) {
  // The other clock is 1000 ahead; 30 there, 10 back, 5 at the other end.
  Trip trip{.lateness = 7};
  complete(trip, 100, 1130, 1135, 145);
  EXPECT_EQ(trip.network, 40);
  EXPECT_EQ(trip.turn, 5);
  EXPECT_EQ(trip.response(), 52);
  EXPECT_EQ(trip.offset, 1010) << "right but for the difference of the ways, at most half of both";
}

// The other end may stamp what it likes within what ProbeFormat lets through: all of it is counted.
TEST(Trip, TakesTheWidestStamps) {
  constexpr std::int64_t kEnd = kProbeLatest - 1, kNow = 1'800'000'000 * (1'000 * kMs);
  for (const auto& [t2, t3] : {std::pair{std::int64_t{0}, kEnd}, {kEnd, std::int64_t{0}}}) {
    Measurement m = steady(4);
    for (Trip& trip : m.trips) complete(trip, kNow, t2, t3, kNow + kMs);
    const bool back_in_time = t3 < t2;
    EXPECT_EQ(m.trips[0].turn, back_in_time ? 0 : kEnd);
    EXPECT_EQ(m.trips[0].network, back_in_time ? kMs + kEnd : 0);
    EXPECT_GT(m.trips[0].response(), 0);
    EXPECT_EQ(figures(m, 1).response.max, kEnd + 100 * kUs + (back_in_time ? kMs : 0));
    const LineVerdict v = line_verdict(m, 1000.0, 10);
    EXPECT_EQ(v.rig.limit, Limit::kSlow);
    EXPECT_EQ(v.slowest, back_in_time ? Part::kNetwork : Part::kWakeThere)
        << "four of them do not fit in 64 bits";
  }
}

TEST(Spread, HasNearestRanks) {
  std::vector<std::int64_t> values;
  for (std::int64_t i = 1000; i >= 1; --i) values.push_back(i);
  const Spread s = spread(values);
  EXPECT_EQ(s.p50, 500);
  EXPECT_EQ(s.p99, 990);
  EXPECT_EQ(s.p999, 999);
  EXPECT_EQ(s.max, 1000);
  EXPECT_EQ(spread({5}).p50, 5);
  EXPECT_EQ(spread({}).max, 0);
}

TEST(Figures, CountBothWays) {
  Measurement m = steady();
  m.ticks = 1003;  // three were slept through
  lose(m, 10, 7);
  m.there->heard.distinct = 996;  // four pings never came
  m.there->heard.late = 2;
  m.there->answered = 996;
  m.there->facts.ttl = 3;
  m.heard.distinct = 993;  // three answers never came back
  m.heard.repeats = 5;
  m.heard.ttl_max = m.heard.ttl_min = 2;
  m.trips[500].network = 20 * kUs;
  m.trips[500].offset = -4 * kMs;
  const Figures f = figures(m, 1);
  EXPECT_EQ(f.missed, 3);
  EXPECT_EQ(f.unanswered, 7);
  EXPECT_EQ(f.out->lost, 4);
  EXPECT_EQ(f.out->late, 2);
  EXPECT_EQ(f.out->ttl_sent, 1);
  EXPECT_EQ(f.back->sent, 996);
  EXPECT_EQ(f.back->lost, 3);
  EXPECT_EQ(f.back->repeats, 5);
  EXPECT_EQ(f.back->ttl_sent, 3);
  EXPECT_EQ(f.back->ttl_min, 2);
  EXPECT_EQ(f.wake_here.max, 100 * kUs);
  EXPECT_EQ(f.network.p50, 150 * kUs);
  EXPECT_EQ(f.jitter.p99, 0);
  EXPECT_EQ(f.jitter.max, 130 * kUs);
  EXPECT_EQ(f.response.max, 300 * kUs);
  EXPECT_EQ(f.clock_offset, -4 * kMs) << "that of the quickest";
  EXPECT_EQ(f.clock_uncertainty, 10 * kUs);

  m.there.reset();
  EXPECT_FALSE(figures(m, 1).out);
}

TEST(Verdict, IsTheHighestRateWhoseBudgetHolds) {
  // 300 us are three quarters of a tick at 2500 Hz.
  const LineVerdict v = line_verdict(steady(), 1000.0, 10);
  EXPECT_TRUE(v.rig.good());
  EXPECT_EQ(v.good_for_hz, 2000.0);
  EXPECT_EQ(v.limited()->rate_hz, 5000.0);
  EXPECT_EQ(v.limited()->limit, Limit::kSlow);
  EXPECT_EQ(v.limited()->budget_ns, 150 * kUs);
  EXPECT_EQ(line_verdict(steady(), 2500.0, 10).good_for_hz, 2500.0)
      << "the rig's own is a candidate";
  EXPECT_FALSE(line_verdict(steady(), 2501.0, 10).rig.good());
}

TEST(Verdict, LetsOneTickInAThousandMissTheBudget) {
  Measurement m = steady();
  m.trips[5].turn = 600 * kUs;  // 850 us, of 750
  EXPECT_TRUE(line_verdict(m, 1000.0, 10).rig.good());
  m.trips[6].turn = 600 * kUs;
  const LineVerdict v = line_verdict(m, 1000.0, 10);
  EXPECT_EQ(v.rig.limit, Limit::kSlow);
  EXPECT_DOUBLE_EQ(v.rig.missed, 0.002);
  EXPECT_EQ(v.good_for_hz, 500.0);
}

TEST(Verdict, NamesThePartThatMakesTicksLate) {
  Measurement m = steady();
  EXPECT_EQ(line_verdict(m, 1000.0, 10).slowest, Part::kNone);
  m.trips[5].turn = 600 * kUs;
  m.trips[6].network = 650 * kUs;
  EXPECT_EQ(line_verdict(m, 1000.0, 10).slowest, Part::kNetwork);
  m.trips[7].turn = 600 * kUs;
  EXPECT_EQ(line_verdict(m, 1000.0, 10).slowest, Part::kWakeThere);
  m.ticks += 2;
  EXPECT_EQ(line_verdict(m, 1000.0, 10).slowest, Part::kWakeHere);
}

TEST(Verdict, CountsTicksThatWereSleptThrough) {
  Measurement m = steady();
  m.ticks += 2;
  EXPECT_EQ(line_verdict(m, 1000.0, 10).rig.limit, Limit::kSlow);
  EXPECT_EQ(line_verdict(m, 1000.0, 10).rig.unanswered, 0.0);
}

TEST(Verdict, IsNoneWhereMoreIsLostThanMayBe) {
  Measurement m = steady();
  lose(m, 5, 1);
  EXPECT_TRUE(line_verdict(m, 1000.0, 10).rig.good());
  lose(m, 500, 1);
  const LineVerdict v = line_verdict(m, 1000.0, 10);
  EXPECT_EQ(v.rig.limit, Limit::kLoss);
  EXPECT_EQ(v.good_for_hz, 0.0);
  EXPECT_EQ(v.limited()->rate_hz, 50.0);
}

TEST(Verdict, SaysNothingGoodOfNothing) {
  Measurement m{.period_ns = kMs};
  EXPECT_FALSE(line_verdict(m, 1000.0, 10).rig.good());
  m = steady();
  lose(m, 0, 1000);
  EXPECT_EQ(line_verdict(m, 1000.0, 10).good_for_hz, 0.0);
  EXPECT_EQ(staleness(m).lost_run, 1000);
  EXPECT_EQ(staleness(m).silence_ns, 1000 * kMs);
}

// A command is never old where each tick's comes before the next one.
TEST(Verdict, AgeOfTheNewestCommandIsZeroOnASteadyLine) {
  const LineVerdict v = line_verdict(steady(), 1000.0, 1);
  EXPECT_EQ(v.rig.age_ticks, 0);
  EXPECT_TRUE(v.rig.good());
}

TEST(Verdict, ARunOfLossesIsASafeStopThoughFewAreLost) {
  Measurement m = steady(100'000);
  lose(m, 700, 9);
  EXPECT_EQ(line_verdict(m, 1000.0, 10).rig.age_ticks, 9);
  EXPECT_TRUE(line_verdict(m, 1000.0, 10).rig.good());
  EXPECT_EQ(line_verdict(m, 100.0, 10).rig.age_ticks, 9) << "as many messages, were it slower";
  EXPECT_EQ(line_verdict(m, 2000.0, 10).rig.limit, Limit::kStale) << "as long, were it faster";
  lose(m, 709, 1);
  EXPECT_EQ(line_verdict(m, 1000.0, 10).rig.limit, Limit::kStale);
  EXPECT_EQ(line_verdict(m, 1000.0, 10).rig.age_ticks, 10);
}

// A network that holds everything up for 25 ms, then delivers it at once, loses nothing.
TEST(Verdict, AStallAgesTheCommandByItsTime) {
  Measurement m = steady(100'000);
  for (std::size_t i = 0; i < 25; ++i) {
    m.trips[700 + i].network = (25 - static_cast<std::int64_t>(i)) * kMs;
  }
  const LineVerdict v = line_verdict(m, 1000.0, 10);
  EXPECT_EQ(v.rig.limit, Limit::kStale);
  EXPECT_EQ(v.rig.age_ticks, 25);
  EXPECT_EQ(v.good_for_hz, 250.0) << "25 ms are 6 ticks of 4 ms";
}

TEST(Verdict, WhatIsOvertakenDoesNotMakeTheCommandNewer) {
  Measurement m = steady(100'000);
  m.trips[10].network = 3 * kMs;
  // When 11's comes, 9's is the newest: 2.3 ms after its tick, of which one is as it should be.
  EXPECT_EQ(staleness(m).silence_ns, 1300 * kUs);
}

}  // namespace
}  // namespace gyrotwin::netcheck
