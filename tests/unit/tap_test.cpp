// A tap keeps all that is the rig's, in whatever order it comes, and nothing that only claims to
// be.
#include "services/runtime/tap.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

struct Kept {
  std::string channel;
  Bytes payload;
  bool operator==(const Kept&) const = default;
};

/// All that comes until `count` were kept; ten seconds at most.
std::vector<Kept> hear(Tap& tap, std::size_t count) {
  std::vector<Kept> kept;
  for (int i = 0; i < 1000 && kept.size() < count; ++i) {
    tap.wait(kSecond / 100);
    while (const auto heard = tap.receive()) {
      kept.push_back({std::string(heard->channel), {heard->payload.begin(), heard->payload.end()}});
    }
  }
  return kept;
}

/// A STATE with this sequence, as sent on the test's rig.
Bytes state_payload(Bus& bus, std::int64_t sequence) {
  state_t state{};
  bus.send(Channel::kState, state, {.epoch = 5, .sequence = sequence});
  return encoded(state);
}

TEST(Tap, KeepsRepeatsAndWhatComesLate) {
  const BusConfig config = test_config(test_key());
  Tap tap(config, Tap::Keep::kRig);
  Bus bus(config);
  std::vector<Kept> sent;
  for (const std::int64_t sequence : {0, 1, 1, 5, 3, 6}) {
    sent.push_back({"TEST/LIVE/STATE", state_payload(bus, sequence)});
  }
  EXPECT_EQ(hear(tap, sent.size()), sent);
  const std::size_t state = 0;
  EXPECT_EQ(tap.counters().received[state], 6);
  EXPECT_EQ(tap.counters().repeats[state], 1);
  EXPECT_EQ(tap.counters().reordered[state], 1);
  EXPECT_EQ(tap.counters().gaps[state], 3);
}

TEST(Tap, StampsWithTheWallClock) {
  const BusConfig config = test_config();
  Tap tap(config, Tap::Keep::kRig);
  Bus bus(config);
  const auto now = [] {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  // The kernel begins to stamp a moment after it was asked to.
  for (int i = 0; i < 100; ++i) {
    const std::int64_t before = now();
    state_payload(bus, i);
    const std::int64_t after = now();
    tap.wait(kSecond);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // apart: when it came, when read
    const auto heard = tap.receive();
    ASSERT_TRUE(heard);
    ASSERT_GE(heard->received_us, before);
    if (heard->received_us <= after) return;
  }
  FAIL() << "stamped when it was read, not when it came";
}

TEST(Tap, KeepsForeignOnesOnRequestAlone) {
  const BusConfig config = test_config(test_key());
  Tap rig(config, Tap::Keep::kRig);
  Tap all(config, Tap::Keep::kAll);
  RawPeer peer(config);
  const Bytes large(60'000, 3);
  peer.send(short_message("pose estimate", Bytes{1}));  // a blank in its name
  peer.send(short_message("pose", large));
  peer.send(Bytes{'L', 'C', '0', '3', 0, 0, 0, 0, 0, 0, 0, 0});  // a fragment
  peer.send(
      short_message("TEST/LIVE/STATE", distinct_payload(Channel::kState, kTestRig)));  // unsigned
  peer.send(short_message("OTHER/REPLY", Bytes{}));
  Bus bus(config);
  const Kept last{"TEST/LIVE/STATE", state_payload(bus, 0)};
  EXPECT_EQ(hear(all, 3), (std::vector<Kept>{{"pose", large}, {"OTHER/REPLY", {}}, last}));
  EXPECT_EQ(hear(rig, 1), std::vector<Kept>{last});
  EXPECT_EQ(all.counters().unauthentic, 1);
  EXPECT_EQ(all.counters().foreign, 4);
}

TEST(Tap, CountsWhatTheKernelDropped) {
  const BusConfig config = test_config();
  Tap tap(config, Tap::Keep::kAll);
  Bus bus(config);
  // More than fits whatever the kernel grants: each takes more than its payload.
  const Bytes payload(60'000, 1);
  const auto count = static_cast<std::size_t>(tap.granted_buffer()) / payload.size() + 100;
  for (std::size_t i = 0; i < count; ++i) ASSERT_TRUE(bus.send_again("pose", payload));
  std::size_t kept = 0;
  while (tap.wait(0)) {
    while (tap.receive()) ++kept;
  }
  EXPECT_LT(kept, count);
  EXPECT_EQ(kept + static_cast<std::size_t>(tap.counters().kernel_dropped), count);
}

TEST(Tap, AllocatesNothing) {
  const BusConfig config = test_config(test_key());
  Tap tap(config, Tap::Keep::kAll);
  Bus bus(config);
  state_payload(bus, 0);
  tap.wait(kSecond);
  const AllocationCounter counter;
  EXPECT_TRUE(tap.receive());
  tap.counters();
  EXPECT_EQ(counter.count(), 0);
}

TEST(SendAgain, SendsAnyPayloadOnAnyChannelAsItIs) {
  const BusConfig config = test_config(test_key());
  Tap tap(config, Tap::Keep::kAll);
  Bus bus(config);
  Bus other(config);
  const Kept state{"TEST/LIVE/STATE", state_payload(other, 7)};
  const Kept large{"pose", Bytes(65'000, 1)};
  hear(tap, 1);
  EXPECT_TRUE(bus.send_again(state.channel, state.payload));
  EXPECT_TRUE(bus.send_again(large.channel, large.payload));
  EXPECT_EQ(hear(tap, 2), (std::vector<Kept>{state, large}));
  EXPECT_FALSE(bus.send_again("pose", Bytes(70'000, 1))) << "no datagram is that large";
  EXPECT_EQ(bus.counters().send_failed, 1);
}

}  // namespace
}  // namespace gyrotwin
