// Hostile datagrams at the running daemons: none dies, each lands in its counter, it balances on.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/distinct.hpp"
#include "tests/support/lab.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using namespace std::string_view_literals;

constexpr int kRounds = 50;

Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

/// One of every kind, and how many of each counter a round of them makes.
struct Hostile {
  std::vector<Bytes> malformed, foreign, other_rig, unauthentic;
};

Hostile hostile(const Rig& rig) {
  const std::string state = rig.network.prefix + "/LIVE/STATE";
  const std::string command = rig.network.prefix + "/LIVE/COMMAND";
  const Bytes payload = distinct_payload(Channel::kState, rig.id);
  Bytes too_short = payload, too_long = payload, wrong_type = payload;
  too_short.resize(payload.size() - 1);
  too_long.push_back(0);
  wrong_type[0] ^= 1;
  Bytes no_nul = text("LC02....");
  no_nul.insert(no_nul.end(), state.begin(), state.end());

  Hostile all;
  all.malformed = {Bytes{},
                   text("LC02"),
                   text("LC02......"),
                   text("XX02....A\0"sv),
                   no_nul,
                   Bytes(60'000, 'A'),
                   short_message(state, {}),
                   short_message(state, too_short),
                   short_message(state, too_long),
                   short_message(state, wrong_type),
                   short_message(state, distinct_payload(Channel::kCommand, rig.id))};
  all.foreign = {short_message("LCM_SELF_TEST", text("self test")),
                 short_message("SOMEBODY/ELSE", text("hello")), short_message(state + "X", payload),
                 text("LC03\0\0\0\1\377\377\377\377\0\0\0\0\0\1\377\377"sv)};
  all.other_rig = {short_message(state, distinct_payload(Channel::kState, rig.id + 1))};
  all.unauthentic = {
      short_message(state, payload),
      short_message(command, distinct_payload(Channel::kCommand, rig.id)),
      short_message(rig.network.prefix + "/REQUEST", distinct_payload(Channel::kRequest, rig.id))};
  return all;
}

TEST(Hostile, DatagramsOfEveryKindAreCountedAndChangeNothing) {
  Lab lab("prototype_b");
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());

  RawPeer peer(bus_config(lab.rig, header_t::OPERATOR));
  const Hostile all = hostile(lab.rig);
  for (int round = 0; round < kRounds; ++round) {
    for (const auto* kind : {&all.malformed, &all.foreign, &all.other_rig, &all.unauthentic}) {
      for (const Bytes& bytes : *kind) peer.send(bytes);
    }
    // As fast as the daemons tick: this is about what they survive, not how much.
    lab.until([](const Reception& r) { return r.channel == Channel::kState; });
  }
  const auto count = [](const std::vector<Bytes>& kind) {
    return kRounds * static_cast<std::int64_t>(kind.size());
  };
  const auto counted = [&](const status_t& s) {
    return s.malformed == count(all.malformed) && s.foreign == count(all.foreign) &&
           s.other_rig == count(all.other_rig) && s.unauthentic == count(all.unauthentic);
  };
  const status_t owner = lab.await_status(counted);
  EXPECT_EQ(owner.malformed, count(all.malformed));
  EXPECT_EQ(owner.foreign, count(all.foreign));
  EXPECT_EQ(owner.other_rig, count(all.other_rig));
  EXPECT_EQ(owner.unauthentic, count(all.unauthentic));
  EXPECT_EQ(owner.mode, status_t::MODE_RUNNING);
  EXPECT_TRUE(lab.controller->running());
}

TEST(Hostile, RandomBytesInValidEnvelopesChangeNothing) {
  Lab lab("double_brennan", {"network.sign=false"});
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.balance());

  // Unsigned, so that content reaches the owner's rules: random COMMAND and REQUEST.
  RawPeer peer(bus_config(lab.rig, header_t::OPERATOR));
  std::mt19937_64 random(7);
  for (int i = 0; i < 3000; ++i) {
    for (const Channel channel : {Channel::kCommand, Channel::kRequest, Channel::kReply}) {
      Bytes payload = distinct_payload(channel, lab.rig.id);
      for (std::size_t k = 8 + 4; k < payload.size(); ++k) {
        payload[k] = static_cast<std::uint8_t>(random());
      }
      peer.send(
          short_message(lab.rig.network.prefix + "/" + std::string(spec(channel).suffix), payload));
    }
    if (i % 50 == 0) lab.until([](const Reception& r) { return r.channel == Channel::kState; });
  }
  const status_t owner = lab.await_status([](const status_t& s) {
    return s.refused_not_finite + s.refused_epoch + s.refused_expired > 300;
  });
  EXPECT_EQ(owner.mode, status_t::MODE_RUNNING);
  EXPECT_TRUE(lab.owner->running());
  EXPECT_TRUE(lab.controller->running());
  EXPECT_EQ(lab.run("ctl", {"status"}), 0) << lab.said;
}

TEST(Hostile, KeyCheckTellsThatSomebodyHasAnotherKey) {
  Lab lab("prototype_b");
  lab.start_owner();
  lab.await_mode(status_t::MODE_HELD);
  EXPECT_EQ(lab.run("key", {"check", "--for", "3"}), 0) << lab.said;
  EXPECT_NE(lab.said.find("all signed with this key"), std::string::npos) << lab.said;

  std::filesystem::remove(key_path(lab.rig.name));
  create_key(key_path(lab.rig.name));  // the owner goes on with the old one
  EXPECT_EQ(lab.run("key", {"check", "--for", "3"}), 1) << lab.said;
  EXPECT_NE(lab.said.find("somebody uses another one"), std::string::npos) << lab.said;

  lab.owner.reset();
  EXPECT_EQ(lab.run("key", {"check"}), 0) << lab.said;
  EXPECT_NE(lab.said.find("nobody was heard"), std::string::npos) << lab.said;
}

}  // namespace
}  // namespace gyrotwin
