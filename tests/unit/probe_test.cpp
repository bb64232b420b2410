// Probes: what is written is read, what only claims to be one is counted and not answered.
#include "services/runtime/probe.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "clients/netcheck/answerer.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin::netcheck {
namespace {

constexpr std::size_t kEnvelope = 9;  // LC02, packet number, NUL

Bytes written(const ProbeFormat& format, const Probe& probe) {
  Frame frame;
  const std::size_t size = format.write(frame, probe);
  return {frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size)};
}

ProbeFormat format_of(const std::optional<Key>& key, std::int32_t rig = kTestRig) {
  return ProbeFormat("TEST", rig, key);
}

Report some_report() {
  Report report{
      .session = 1, .answerer = 2, .serial = 3, .answered = 4, .over_rate = 5, .unauthentic = 6};
  report.facts = {.mtu = 7,
                  .ttl = 8,
                  .buffer_wanted = 9,
                  .buffer_granted = 10,
                  .priority_error = 11,
                  .memory_error = 12,
                  .clock_synchronised = 13,
                  .clock_max_error_ns = -14,
                  .saves_power = 15,
                  .wireless = 16};
  set_text(report.facts.host, "lab");
  set_text(report.facts.interface, "eth0");
  report.heard = {.distinct = 17,
                  .repeats = 18,
                  .late = 19,
                  .ttl_min = 20,
                  .ttl_max = 21,
                  .kernel_dropped = kProbeMost};
  set_text(report.heard.interface, "eth1");
  return report;
}

TEST(ProbeFormat, ReadsWhatItHasWritten) {
  const ProbeFormat format = format_of(test_key());
  const auto question = format.judge(written(format, Question{1, -1, 3}));
  ASSERT_EQ(question.verdict, Verdict::kGood);
  EXPECT_EQ(std::get<Question>(question.probe).target, -1);
  EXPECT_EQ(std::get<Question>(question.probe).serial, 3);

  const auto ping = format.judge(written(format, Ping{4, 5, 6}));
  EXPECT_EQ(std::get<Ping>(ping.probe).session, 4);
  EXPECT_EQ(std::get<Ping>(ping.probe).target, 5);
  EXPECT_EQ(std::get<Ping>(ping.probe).sequence, 6);

  const auto answer = format.judge(written(format, Answer{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(std::get<Answer>(answer.probe).number, 4);
  EXPECT_EQ(std::get<Answer>(answer.probe).received_ns, 5);
  EXPECT_EQ(std::get<Answer>(answer.probe).sent_ns, 6);

  // Every field, at its own place: bytes that are written again are the same.
  const Bytes bytes = written(format, some_report());
  const auto report = format.judge(bytes);
  ASSERT_EQ(report.verdict, Verdict::kGood);
  EXPECT_EQ(written(format, report.probe), bytes);
  const auto& read = std::get<Report>(report.probe);
  EXPECT_EQ(get_text(read.facts.host), "lab");
  EXPECT_EQ(get_text(read.heard.interface), "eth1");
  EXPECT_EQ(read.facts.clock_max_error_ns, -14);
  EXPECT_EQ(read.heard.kernel_dropped, kProbeMost);
}

TEST(ProbeFormat, IsAsLargeAsWhatItStandsFor) {
  const ProbeFormat format = format_of(test_key());
  const auto payload = [&](const Probe& probe, std::string_view channel) {
    return written(format, probe).size() - kEnvelope - channel.size();
  };
  EXPECT_EQ(payload(Ping{}, "TEST/NETCHECK/PING"), kWireSize<state_t>);
  EXPECT_EQ(payload(Answer{}, "TEST/NETCHECK/ANSWER"), kWireSize<command_t>);
  // Nobody is made to send more than was sent to him.
  EXPECT_LE(payload(Report{}, "TEST/NETCHECK/REPORT"),
            payload(Question{}, "TEST/NETCHECK/QUESTION"));
}

TEST(ProbeFormat, TellsWhatIsWrong) {
  const ProbeFormat format = format_of(test_key());
  const Bytes ping = written(format, Ping{1, 2, 3});
  EXPECT_EQ(format_of(test_key(), 8).judge(ping).verdict, Verdict::kOtherRig);
  EXPECT_EQ(ProbeFormat("OTHER", kTestRig, test_key()).judge(ping).verdict, Verdict::kForeign);
  Key other = test_key();
  other[0] ^= 1;
  EXPECT_EQ(format_of(other).judge(ping).verdict, Verdict::kUnauthentic);
  EXPECT_EQ(format.judge(written(format_of({}), Ping{1, 2, 3})).verdict, Verdict::kUnauthentic);
  EXPECT_EQ(format.judge(written(format, Ping{1, 2, -3})).verdict, Verdict::kMalformed);
  EXPECT_EQ(format.judge(written(format, Answer{.number = -1})).verdict, Verdict::kMalformed);
  EXPECT_EQ(format.judge(short_message("TEST/LIVE/STATE", {})).verdict, Verdict::kMalformed);
  EXPECT_EQ(format.judge(short_message("TEST/NETCHECK/WHAT", {})).verdict, Verdict::kForeign);
}

// Numbers that no honest peer has would overflow where they are computed with.
TEST(ProbeFormat, BoundsEveryNumber) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  const ProbeFormat format = format_of(test_key());
  const auto verdict = [&](const Probe& probe) {
    return format.judge(written(format, probe)).verdict;
  };
  const auto good = Verdict::kGood, bad = Verdict::kMalformed;

  EXPECT_EQ(verdict(Question{kMax, kMin, kProbeMost}), good) << "names are of any bits";
  EXPECT_EQ(verdict(Question{1, -1, kProbeMost + 1}), bad);
  EXPECT_EQ(verdict(Ping{kMax, kMin, kProbeMost}), good);
  EXPECT_EQ(verdict(Ping{1, 2, kMax}), bad);
  EXPECT_EQ(verdict(Answer{kMax, kMin, kProbeMost, kProbeMost, kProbeLatest - 1, 0}), good);
  for (const std::int64_t stamp : {kMin, std::int64_t{-1}, kProbeLatest, kMax}) {
    EXPECT_EQ(verdict(Answer{.received_ns = stamp}), bad) << stamp;
    EXPECT_EQ(verdict(Answer{.sent_ns = stamp}), bad) << stamp;
  }
  EXPECT_EQ(verdict(Answer{.sequence = kProbeMost + 1}), bad);
  EXPECT_EQ(verdict(Answer{.number = kProbeMost + 1}), bad);

  // A report: every number but its two names, the first and second after layout and rig.
  Bytes report = written(format_of({}), some_report());
  const std::size_t payload = kEnvelope + std::string_view("TEST/NETCHECK/REPORT").size();
  std::size_t refused = 0;
  for (std::size_t at = payload + 16; at + 8 <= report.size(); at += 8) {
    Bytes turned = report;
    turned[at] ^= 0x40;  // of a number: 2^62
    refused += format_of({}).judge(turned).verdict == bad;
  }
  // 6 + 10 + 6 numbers, without the names; texts, zeros and the signature may be anything.
  EXPECT_EQ(refused, 20u);
}

// Whatever bit is turned and wherever it is cut, it is no longer good: but for the packet number,
// which anybody may write.
TEST(ProbeFormat, TakesNoBitForAnother) {
  const ProbeFormat format = format_of(test_key());
  const Bytes ping = written(format, Ping{1, 2, 3});
  for (std::size_t i = 0; i < 8 * ping.size(); ++i) {
    if (i >= 32 && i < 64) continue;
    Bytes turned = ping;
    turned[i / 8] ^= static_cast<std::uint8_t>(1u << i % 8);
    EXPECT_NE(format.judge(turned).verdict, Verdict::kGood) << i;
  }
  for (std::size_t size = 0; size < ping.size(); ++size) {
    EXPECT_NE(format.judge(std::span(ping).first(size)).verdict, Verdict::kGood) << size;
  }
}

TEST(ProbeFormat, SurvivesAnyBytes) {
  const ProbeFormat format = format_of({});
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = written(format, some_report());
    bytes.resize(random() % (bytes.size() + 20));
    for (int n = 0; n < 8 && !bytes.empty(); ++n) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    (void)format.judge(bytes);
  }
}

Arrival came(const Probe& probe, int ttl = 1) {
  return {.probe = probe, .received_ns = 77, .ttl = ttl, .interface = 1};
}

TEST(Answerer, AnswersEachPingOnce) {
  Answerer answerer(9, {});
  const auto first = answerer.answer(came(Ping{1, 9, 0}), {}, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(std::get<Answer>(*first).answerer, 9);
  EXPECT_EQ(std::get<Answer>(*first).received_ns, 77);
  EXPECT_FALSE(answerer.answer(came(Ping{1, 9, 0}), {}, 0)) << "came twice";
  EXPECT_FALSE(answerer.answer(came(Ping{1, 8, 1}), {}, 0)) << "for somebody else";
  EXPECT_FALSE(answerer.answer(came(Answer{1, 9, 0}), {}, 0)) << "no question";
  const auto third = answerer.answer(came(Ping{1, 9, 3}, 2), {}, 0);
  EXPECT_EQ(std::get<Answer>(*third).number, 1) << "the second answer of the session";
  ASSERT_TRUE(answerer.answer(came(Ping{1, 9, 2}, 1), {}, 0));

  const auto report = answerer.answer(came(Question{1, 9, 5}, 1), {{.unauthentic = 6}}, 0);
  ASSERT_TRUE(report);
  const auto& r = std::get<Report>(*report);
  EXPECT_EQ(r.serial, 5);
  EXPECT_EQ(r.answered, 3);
  EXPECT_EQ(r.unauthentic, 6);
  EXPECT_EQ(r.heard.distinct, 3);
  EXPECT_EQ(r.heard.repeats, 1);
  EXPECT_EQ(r.heard.late, 1);
  EXPECT_EQ(r.heard.ttl_min, 1);
  EXPECT_EQ(r.heard.ttl_max, 2);
  EXPECT_FALSE(answerer.answer(came(Question{1, 8, 0}), {}, 0)) << "for somebody else";
}

TEST(Answerer, KeepsSessionsApartAndForgetsTheOldest) {
  Answerer answerer(9, {});
  for (std::int64_t session = 0; session < 17; ++session) {
    EXPECT_TRUE(answerer.answer(came(Ping{session, 9, 0}), {}, 0));
  }
  EXPECT_FALSE(answerer.answer(came(Ping{16, 9, 0}), {}, 0));
  EXPECT_FALSE(answerer.answer(came(Ping{1, 9, 0}), {}, 0));
  EXPECT_TRUE(answerer.answer(came(Ping{0, 9, 0}), {}, 0)) << "forgotten, so it is new";
}

// A question to everybody names no run: old ones that are played back must not end a session.
TEST(Answerer, QuestionsChangeNoSession) {
  Answerer answerer(9, {});
  for (std::int64_t session = 0; session < 16; ++session) {
    EXPECT_TRUE(answerer.answer(came(Ping{session, 9, 0}), {}, 0));
  }
  for (std::int64_t old = 100; old < 200; ++old) {
    const auto report =
        answerer.answer(came(Question{old, -1, 3}, 5), {{.unauthentic = 6}}, old * kSecond);
    ASSERT_TRUE(report);
    const auto& r = std::get<Report>(*report);
    EXPECT_EQ(r.session, old);
    EXPECT_EQ(r.serial, 3);
    EXPECT_EQ(r.unauthentic, 6);
    EXPECT_EQ(r.answered, 0);
    EXPECT_EQ(r.heard.distinct, 0);
    EXPECT_EQ(r.heard.ttl_max, -1);
  }
  for (std::int64_t session = 0; session < 16; ++session) {
    EXPECT_FALSE(answerer.answer(came(Ping{session, 9, 0}), {}, 200 * kSecond)) << session;
  }
  // Nor does one keep its session from being the next that is forgotten, or count as heard in it.
  const auto report = answerer.answer(came(Question{0, -1, 0}, 5), {}, 200 * kSecond);
  EXPECT_EQ(std::get<Report>(*report).heard.ttl_max, 1);
  EXPECT_TRUE(answerer.answer(came(Ping{16, 9, 0}), {}, 200 * kSecond));
  EXPECT_TRUE(answerer.answer(came(Ping{0, 9, 0}), {}, 200 * kSecond)) << "forgotten, so it is new";
}

TEST(Answerer, HasAnUpperLimitOfItsRate) {
  Answerer answerer(9, {});
  constexpr std::int64_t kPings = 100'000;  // within a second
  std::int64_t answered = 0;
  for (std::int64_t n = 0; n < kPings; ++n) {
    answered += answerer.answer(came(Ping{1, 9, n}), {}, kSecond / kPings * n).has_value();
  }
  // One more or less for the fraction that is left at the end.
  EXPECT_NEAR(answered, Answerer::kMostPerSecond + Answerer::kMostAtOnce, 1);
  const auto report = answerer.answer(came(Question{1, 9, 0}), {}, 2 * kSecond);
  EXPECT_EQ(std::get<Report>(*report).over_rate, kPings - answered);
}

TEST(Answerer, ReportsMoreRarely) {
  Answerer answerer(9, {});
  constexpr std::int64_t kQuestions = 10'000;  // within a second
  std::int64_t answered = 0;
  for (std::int64_t n = 0; n < kQuestions; ++n) {
    answered += answerer.answer(came(Question{1, -1, n}), {}, kSecond / kQuestions * n).has_value();
  }
  EXPECT_NEAR(answered, Answerer::kMostReportsPerSecond + Answerer::kMostReportsAtOnce, 1);
}

/// The next probe, waited for up to ten seconds.
std::optional<Arrival> hear_soon(ProbeSocket& socket) {
  for (int i = 0; i < 100; ++i) {
    if (auto arrival = socket.receive()) return arrival;
    socket.wait(kSecond / 10);
  }
  return {};
}

TEST(ProbeSocket, CountsWhatIsNoneAndHearsTheNextOne) {
  const BusConfig config = test_config(test_key());
  ProbeSocket ear(config), mouth(config);
  RawPeer stranger(config);
  const Bytes unsigned_ping = written(format_of({}), Ping{1, 2, 3});
  stranger.send(unsigned_ping);
  stranger.send(Bytes(100, 0x55));
  stranger.send(written(format_of(test_key(), 8), Ping{1, 2, 3}));
  stranger.send(short_message("TEST/ELSE", {}));
  ear.send(Ping{0, 0, 0});  // is not heard by itself
  mouth.send(Ping{1, 2, 3});

  const auto heard = hear_soon(ear);
  ASSERT_TRUE(heard);
  EXPECT_EQ(std::get<Ping>(heard->probe).sequence, 3);
  EXPECT_EQ(address_text(heard->from), address_text(mouth.own_address()));
  EXPECT_EQ(heard->from.sin_port, mouth.own_address().sin_port);
  EXPECT_EQ(heard->ttl, 0);
  EXPECT_EQ(interface_name(heard->interface), "lo");
  EXPECT_GT(heard->received_ns, 0);
  EXPECT_LE(heard->received_ns, wall_ns());
  EXPECT_FALSE(ear.receive());
  const ProbeCounters& c = ear.counters();
  EXPECT_EQ(c.unauthentic, 1);
  EXPECT_EQ(c.malformed, 1);
  EXPECT_EQ(c.other_rig, 1);
  EXPECT_EQ(c.foreign, 1);
  EXPECT_GE(ear.granted_buffer(), 256 << 10);
  EXPECT_EQ(ear.mtu(), 65'536);
}

}  // namespace
}  // namespace gyrotwin::netcheck
