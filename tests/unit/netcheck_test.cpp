// What a line is good for, from what was measured; and what is said of it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "clients/netcheck/arrivals.hpp"
#include "clients/netcheck/quantity.hpp"
#include "clients/netcheck/report.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kUs = 1'000;

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

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

/// A second at 1 kHz whose answers all come 300 us after the tick: 100 us late, 150 on the network,
/// 50 at the other end.
Measurement steady(std::int64_t ticks = 1000) {
  Measurement m{.period_ns = kMs, .ticks = ticks};
  for (std::int64_t k = 0; k < ticks; ++k) {
    m.trips.push_back({.tick = k, .lateness = 100 * kUs, .network = 150 * kUs, .turn = 50 * kUs});
  }
  m.heard.distinct = ticks;
  m.there = Report{.answered = ticks, .heard = {.distinct = ticks}};
  return m;
}

void lose(Measurement& m, std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) m.trips[i].network = Trip::kNever;
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

Netcheck checked(const Measurement& m) {
  Netcheck check{.rig = load_rig("prototype_b", {"network.interface=\"eth0\"", "network.ttl=1"}),
                 .rig_words = "--rig prototype_b",
                 .port = 8671,
                 .address = "198.51.100.1"};
  check.here = {.mtu = 1500,
                .ttl = 1,
                .buffer_wanted = 8 << 20,
                .buffer_granted = 8 << 20,
                .clock_synchronised = 1};
  set_text(check.here.host, "bench");
  set_text(check.here.interface, "eth0");
  CheckedLine line;
  line.peer.address = "198.51.100.2";
  line.peer.facts = check.here;
  line.figures = figures(m, 1);
  line.verdict = line_verdict(m, 1000.0, 10);
  line.rate_hz = 1000.0;
  set_text(line.peer.facts.host, "plant");
  check.lines.push_back(line);
  return check;
}

/// The advice that has this in its text, and its commands.
std::string advice_about(const Netcheck& check, std::string_view what) {
  for (const Advice& a : advice(check)) {
    if (!contains(a.text, what)) continue;
    std::string text = a.text;
    for (const std::string& command : a.commands) text += "\n" + command;
    return text;
  }
  return {};
}

TEST(Advice, IsSilentWhereAllIsWell) { EXPECT_TRUE(advice(checked(steady())).empty()); }

TEST(Advice, NamesTheHostAndTheCommand) {
  Netcheck check = checked(steady());
  HostFacts& there = check.lines[0].peer.facts;
  there.priority_error = EPERM;
  there.memory_error = EPERM;
  there.buffer_granted = 425'984;
  there.mtu = 1000;
  there.clock_synchronised = 0;
  there.saves_power = 1;
  there.wireless = 1;
  EXPECT_TRUE(contains(advice_about(check, "plant: no right to a realtime priority"),
                       "\necho \"$USER - rtprio 80\" |"));
  EXPECT_TRUE(contains(advice_about(check, "plant: no right to lock"), "memlock unlimited"));
  EXPECT_TRUE(contains(advice_about(check, "plant: the receive buffer has 426 kB"),
                       "sysctl -w net.core.rmem_max=4194304"));
  EXPECT_TRUE(contains(advice_about(check, "plant: eth0 takes packets of 1000 bytes"),
                       "ip link set eth0 mtu 1500"));
  EXPECT_TRUE(contains(advice_about(check, "plant: the clock"), "timedatectl set-ntp true"));
  EXPECT_TRUE(contains(advice_about(check, "plant: its processors"), "cpupower"));
  EXPECT_FALSE(advice_about(check, "is a radio").empty());
  EXPECT_EQ(advice(check).size(), 7) << "and nothing of bench, where all is well";
}

TEST(Advice, TellsTheWaysApart) {
  Measurement m = steady();
  lose(m, 0, 30);
  m.there->heard.distinct = 980;
  m.there->answered = 980;
  m.heard.distinct = 970;
  m.heard.repeats = 3;
  m.there->heard.late = 4;
  m.there->heard.ttl_min = m.there->heard.ttl_max = 0;
  const Netcheck check = checked(m);
  EXPECT_TRUE(
      contains(advice_about(check, "bench to plant: 20 (2 %) lost"), "ip -s link show eth0"));
  EXPECT_FALSE(advice_about(check, "plant to bench: 10 (1 %) lost").empty());
  EXPECT_FALSE(advice_about(check, "plant to bench: 3 (0.31 %) came twice").empty());
  EXPECT_FALSE(advice_about(check, "bench to plant: 4 (0.4 %) overtaken").empty());
  EXPECT_FALSE(advice_about(check, "sent with TTL 1, arrived with 0").empty());
}

TEST(Advice, BlamesWhoTakesTheTime) {
  const auto slow = [](std::int64_t Trip::*part) {
    Measurement m = steady();
    for (Trip& trip : m.trips) trip.*part = 2 * kMs;
    return checked(m);
  };
  EXPECT_FALSE(advice_about(slow(&Trip::lateness), "bench: wakes up 2 ms late").empty());
  EXPECT_FALSE(advice_about(slow(&Trip::turn), "plant: wakes up 2 ms late").empty());
  EXPECT_TRUE(contains(advice_about(slow(&Trip::network), "bench to plant and back takes 2 ms"),
                       "ethtool -C eth0 rx-usecs 0"));
}

TEST(Advice, SaysWhenClocksDisagree) {
  Measurement m = steady();
  for (Trip& trip : m.trips) trip.offset = 5 * kMs;
  EXPECT_FALSE(advice_about(checked(m), "bench and plant are 5 ms apart").empty());
  for (Trip& trip : m.trips) trip.offset = kMs;  // within what logs may differ by
  EXPECT_TRUE(advice_about(checked(m), "apart").empty());
}

TEST(Advice, GuessesWhyNobodyAnswers) {
  Netcheck check = checked(steady());
  check.lines.clear();
  EXPECT_TRUE(contains(advice_about(check, "nobody listens"),
                       "gyrotwin netcheck listen --rig prototype_b"));
  EXPECT_TRUE(contains(advice_about(check, "a firewall"), "port 7671,8671"));
  EXPECT_TRUE(contains(advice_about(check, "another key"), "gyrotwin key show"));
  EXPECT_TRUE(advice_about(check, "network.ttl is 0").empty());
  check.rig.network.ttl = 0;
  EXPECT_FALSE(advice_about(check, "network.ttl is 0").empty());
  EXPECT_FALSE(check.good());
}

TEST(Report, FitsInEightyColumns) {
  Measurement m = steady();
  for (Trip& trip : m.trips) trip.lateness = 123'456'789;
  m.there->heard.distinct = 900;
  m.there->answered = 900;
  m.heard.distinct = 800;
  m.heard.late = m.heard.repeats = 77;
  Netcheck check = checked(m);
  check.here.priority_error = check.here.memory_error = EPERM;
  check.lines[0].peer.facts = check.here;
  set_text(check.here.host, "a-name-of-some-length");
  check.lines.push_back(check.lines.front());
  for (const Netcheck& c : {check, Netcheck{.rig = check.rig, .broken = "eth0 is down"},
                            Netcheck{.rig = check.rig, .rig_words = check.rig_words}}) {
    std::istringstream text(report_text(c));
    for (std::string line; std::getline(text, line);) EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(Report, SaysTheVerdictFirstInItsLine) {
  EXPECT_TRUE(contains(report_text(checked(steady())),
                       "\nGOOD for this rig's 1000 Hz, and up to 2000 Hz\n"));
  EXPECT_TRUE(contains(report_text(checked(steady())), "Nothing to fix.\n"));
  Measurement m = steady();
  lose(m, 0, 50);
  EXPECT_TRUE(contains(report_text(checked(m)),
                       "\nNOT GOOD for this rig's 1000 Hz; good for no rate\n"
                       "  1000 Hz: 5 % of the ticks have no answer at all (0.1 % may)\n"));
}

TEST(Report, JsonHasTheSame) {
  const auto json = nlohmann::json::parse(report_json(checked(steady())));
  EXPECT_EQ(json["good"], true);
  const auto& line = json["lines"][0];
  EXPECT_EQ(line["good_for_hz"], 2000.0);
  EXPECT_EQ(line["out"]["sent"], 1000);
  EXPECT_DOUBLE_EQ(line["response_s"]["p99_9"].get<double>(), 300e-6);
  EXPECT_EQ(line["rates"].size(), kRates.size());
  EXPECT_EQ(line["rates"].back()["limit"], nullptr);
  EXPECT_TRUE(json["advice"].empty());
}

TEST(Quantity, HasThreeDigits) {
  EXPECT_EQ(time_text_ns(0), "0 us");
  EXPECT_EQ(time_text_ns(12'345), "12.3 us");
  EXPECT_EQ(time_text_ns(999'499), "999 us");
  EXPECT_EQ(time_text_ns(999'600), "1 ms");
  EXPECT_EQ(time_text_ns(-1'500'000), "-1.5 ms");
  EXPECT_EQ(time_text_ns(1'770'000'000'000'000), "1.77e+06 s");
  EXPECT_EQ(count_text(503, 10'000), "503 (5 %)");
  EXPECT_EQ(count_text(0, 0), "0");
  EXPECT_EQ(bytes_text(8'388'608), "8.39 MB");
}

}  // namespace
}  // namespace gyrotwin
