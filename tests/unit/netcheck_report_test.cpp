// What is said of a line, and what is to be fixed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "clients/common/time_text.hpp"
#include "clients/netcheck/quantity.hpp"
#include "clients/netcheck/report.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/measurement.hpp"

namespace gyrotwin::netcheck {
namespace {

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
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

// Commands are meant to be pasted; what a peer calls its interface is his.
TEST(Advice, QuotesWhatAPeerSays) {
  Measurement m = steady();
  for (Trip& trip : m.trips) trip.network = 2 * kMs;
  m.there->heard.distinct = 900;
  m.there->answered = 900;
  m.heard.distinct = 800;
  Netcheck check = checked(m);
  for (HostFacts* facts : {&check.here, &check.lines[0].peer.facts}) {
    facts->mtu = 1000;
    set_text(facts->interface, "a;b");
  }
  check.rig.network.group = "a;b";
  std::vector<std::string> commands;
  for (int pass = 0; pass < 2; ++pass) {
    for (const Advice& a : advice(check)) {
      commands.insert(commands.end(), a.commands.begin(), a.commands.end());
    }
    check.lines.clear();  // nobody answers
  }
  int quoted = 0;
  for (std::string command : commands) {
    for (auto at = command.find("'a;b'"); at != std::string::npos; at = command.find("'a;b'")) {
      command.erase(at, 5);
      ++quoted;
    }
    EXPECT_FALSE(contains(command, "a;b")) << command;
  }
  // Two of what is lost on either way, the adapter that gathers, three MTUs, the firewall.
  EXPECT_EQ(quoted, 2 * 2 + 1 + 3 + 1);
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
  EXPECT_FALSE(
      advice_about(slow(&Trip::lateness), "bench: wakes up as late as 2 ms (p99.9 2 ms)").empty());
  EXPECT_FALSE(
      advice_about(slow(&Trip::turn), "plant: wakes up as late as 2 ms (p99.9 2 ms)").empty());
  EXPECT_TRUE(
      contains(advice_about(slow(&Trip::network), "bench to plant and back takes as long as 2 ms"),
               "ethtool -C eth0 rx-usecs 0"));
}

// One long sleep among thousands of good ticks is no p99.9, but a SAFE_STOP.
TEST(Advice, BlamesWhoWasMuchTooLateOnce) {
  Measurement m = steady(100'000);
  for (Trip& trip : m.trips) trip.network = 200 * kUs;
  for (std::size_t i = 0; i < 25; ++i) {
    m.trips[700 + i].turn = (25 - static_cast<std::int64_t>(i)) * kMs;
  }
  EXPECT_FALSE(advice_about(checked(m), "plant: wakes up as late as 25 ms (p99.9 50 us)").empty());
}

TEST(Advice, CallsHostsOfOneNameByTheirAddresses) {
  Measurement m = steady();
  lose(m, 0, 30);
  m.there->heard.distinct = 970;
  m.there->answered = 970;
  m.heard.distinct = 970;
  Netcheck check = checked(m);
  set_text(check.lines[0].peer.facts.host, "bench");
  check.lines[0].peer.facts.saves_power = 1;
  EXPECT_FALSE(advice_about(check, "198.51.100.1 to 198.51.100.2: 30").empty());
  EXPECT_FALSE(advice_about(check, "198.51.100.2: its processors").empty());
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
  EXPECT_TRUE(contains(advice_about(check, "another key"), "gyrotwin key show-id"));
  EXPECT_TRUE(advice_about(check, "network.ttl is 0").empty());
  check.rig.network.ttl = 0;
  EXPECT_FALSE(advice_about(check, "network.ttl is 0").empty());
  EXPECT_FALSE(check.good());
}

TEST(Report, IsNotGoodWhereAHostIsMissing) {
  Netcheck check = checked(steady());
  check.hosts = 1;
  EXPECT_TRUE(check.good());
  check.hosts = 2;
  EXPECT_FALSE(check.good());
  EXPECT_FALSE(advice_about(check, "nobody listens there").empty());
  EXPECT_TRUE(contains(report_text(check), "\nNOT GOOD: 1 of 2 hosts answered\n"));
  EXPECT_EQ(nlohmann::json::parse(report_json(check))["complete"], false);
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
}  // namespace gyrotwin::netcheck
