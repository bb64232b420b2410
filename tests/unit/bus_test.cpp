#include "services/runtime/bus.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/allocation_counter.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

constexpr std::size_t kStateSlot = static_cast<std::size_t>(Channel::kState);

/// Sends a STATE of this epoch and sequence.
void send_state(Bus& bus, std::int64_t epoch, std::int64_t sequence) {
  state_t state{};
  bus.send(Channel::kState, state, {.epoch = epoch, .sequence = sequence});
}

/// Reads until nothing waits. @return the sequences of the STATEs delivered.
std::vector<std::int64_t> drain(Bus& bus) {
  std::vector<std::int64_t> sequences;
  state_t state;
  while (const auto reception = bus.receive()) {
    if (reception->channel != Channel::kState) continue;
    Bus::decode(*reception, state);
    sequences.push_back(state.header.sequence);
  }
  return sequences;
}

class BusTest : public ::testing::TestWithParam<bool> {
 protected:
  BusConfig config() const {
    return test_config(GetParam() ? std::optional(test_key()) : std::nullopt);
  }
};
INSTANTIATE_TEST_SUITE_P(, BusTest, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Signed" : "Unsigned"; });

TEST_P(BusTest, CarriesEveryFieldAndFillsTheHeader) {
  Bus ears(config());
  Bus mouth(config());
  auto sent = distinct<request_t>();
  mouth.send(Channel::kRequest, sent, {.epoch = 11, .sequence = 22, .tick = 33, .sim_time_ns = 44});
  const auto reception = receive_soon(ears);
  ASSERT_TRUE(reception);
  EXPECT_EQ(reception->channel, Channel::kRequest);
  EXPECT_FALSE(reception->repeat);
  request_t heard;
  Bus::decode(*reception, heard);
  EXPECT_EQ(encoded(heard), encoded(sent)) << "send() fills in the message itself, mac included";
  EXPECT_EQ(heard.header.rig_id, kTestRig);
  EXPECT_EQ(heard.header.source, header_t::SIMULATION);
  EXPECT_EQ(heard.header.epoch, 11);
  EXPECT_EQ(heard.header.sequence, 22);
  EXPECT_EQ(heard.header.tick, 33);
  EXPECT_EQ(heard.header.sim_time_ns, 44);
  EXPECT_NE(heard.header.sender_mono_ns, 0);
  const Bytes zeros(kMacSize);
  EXPECT_EQ(Bytes(heard.mac, heard.mac + kMacSize) == zeros, !GetParam());
}

TEST_P(BusTest, CarriesEveryChannel) {
  Bus ears(config());
  Bus mouth(config());
  auto state = distinct<state_t>();
  auto command = distinct<command_t>();
  auto request = distinct<request_t>();
  auto reply = distinct<reply_t>();
  auto truth = distinct<truth_t>();
  auto status = distinct<status_t>();
  auto sensors = distinct<sensors_t>();
  auto link = distinct<link_t>();
  auto health = distinct<health_t>();
  auto forecast = distinct<forecast_t>();
  mouth.send(Channel::kState, state, {});
  mouth.send(Channel::kCommand, command, {});
  mouth.send(Channel::kRequest, request, {});
  mouth.send(Channel::kReply, reply, {});
  mouth.send(Channel::kTruth, truth, {});
  mouth.send(Channel::kIntegratorStatus, status, {});
  mouth.send(Channel::kControllerStatus, status, {});
  mouth.send(Channel::kSensors, sensors, {});
  mouth.send(Channel::kHardwareStatus, status, {});
  mouth.send(Channel::kLink, link, {});
  mouth.send(Channel::kMirrorStatus, status, {});
  mouth.send(Channel::kTwinState, state, {});
  mouth.send(Channel::kHealth, health, {});
  mouth.send(Channel::kForecast, forecast, {});
  mouth.send(Channel::kGatewayStatus, status, {});
  for (const ChannelSpec& row : kChannels) {
    const auto reception = receive_soon(ears);
    ASSERT_TRUE(reception);
    EXPECT_EQ(reception->channel, row.channel);
    EXPECT_EQ(reception->payload.size(), row.size);
    EXPECT_EQ(mouth.counters().sent[static_cast<std::size_t>(row.channel)], 1);
    EXPECT_EQ(ears.counters().received[static_cast<std::size_t>(row.channel)], 1);
  }
}

TEST_P(BusTest, DoesNotHearItself) {
  Bus ears(config());
  Bus mouth(config());
  send_state(mouth, 1, 0);
  ASSERT_TRUE(receive_soon(ears));
  EXPECT_FALSE(mouth.wait(0)) << "nor does it wake up for itself";
  EXPECT_FALSE(mouth.receive());
  EXPECT_EQ(mouth.counters().received[kStateSlot], 0);
}

TEST_P(BusTest, DoesNotAllocate) {
  Bus ears(config());
  Bus mouth(config());
  RawPeer peer(config());
  const Bytes foreign = short_message("LCM_SELF_TEST", {});
  state_t state{};
  status_t status{};

  const AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    mouth.send(Channel::kState, state, {.epoch = i / 4, .sequence = i});
    mouth.send(Channel::kIntegratorStatus, status, {.epoch = 1, .sequence = i});
    peer.send(foreign);
    ears.wait(kSecond);
    while (const auto reception = ears.receive()) {
      if (reception->channel == Channel::kState) Bus::decode(*reception, state);
    }
    mouth.receive();
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(ears.counters().received[kStateSlot], 100);
  EXPECT_EQ(ears.counters().foreign, 100);
}

TEST(AllocationCounter, CountsWhatItIsAskedToCount) {
  const AllocationCounter allocations;
  std::vector<int*> kept;  // one
  kept.push_back(new int(1));
  EXPECT_GE(allocations.count(), 2);
  const AllocationCounter later;
  void* volatile block = malloc(10);
  EXPECT_EQ(later.count(), 1);
  free(block);
  delete kept.front();
}

TEST(BusSigning, DropsWhatAnotherKeyOrNoneSigned) {
  Bus ears(test_config(test_key()));
  Key wrong = test_key();
  wrong[0] ^= 1;
  Bus stranger(test_config(wrong));
  Bus nobody(test_config());
  Bus friendly(test_config(test_key()));
  send_state(stranger, 1, 0);
  send_state(nobody, 2, 0);
  send_state(friendly, 3, 5);
  const auto reception = receive_soon(ears);
  ASSERT_TRUE(reception);
  state_t state;
  Bus::decode(*reception, state);
  EXPECT_EQ(state.header.epoch, 3);
  EXPECT_EQ(ears.counters().unauthentic, 2);
  EXPECT_EQ(ears.counters().received[kStateSlot], 1);
}

TEST(BusRigs, TwoOnOneGroupDoNotMeet) {
  BusConfig second = test_config(test_key());
  second.rig_id = kTestRig + 1;
  second.key->front() ^= 1;
  Bus ears_a(test_config(test_key()));
  Bus ears_b(second);
  Bus mouth_a(test_config(test_key()));
  Bus mouth_b(second);
  send_state(mouth_a, 1, 10);
  send_state(mouth_b, 2, 20);
  for (Bus* ears : {&ears_a, &ears_b}) {
    const auto reception = receive_soon(*ears);
    ASSERT_TRUE(reception);
    state_t state;
    Bus::decode(*reception, state);
    EXPECT_EQ(state.header.rig_id, ears == &ears_a ? kTestRig : kTestRig + 1);
    drain(*ears);
    EXPECT_EQ(ears->counters().received[kStateSlot], 1);
    EXPECT_EQ(ears->counters().other_rig, 1);
    EXPECT_EQ(ears->counters().unauthentic, 0) << "another rig is not an attack";
  }
}

TEST(BusSequences, CountsGapsRepeatsAndReorders) {
  Bus ears(test_config());
  Bus mouth(test_config());
  for (const std::int64_t sequence : {7, 8, 8, 8, 12, 9, 11, 12, 13})
    send_state(mouth, 1, sequence);
  ears.wait(kSecond);
  std::vector<std::int64_t> delivered;
  std::vector<bool> repeats;
  state_t state;
  while (const auto reception = ears.receive()) {
    Bus::decode(*reception, state);
    delivered.push_back(state.header.sequence);
    repeats.push_back(reception->repeat);
  }
  EXPECT_EQ(delivered, (std::vector<std::int64_t>{7, 8, 8, 8, 12, 12, 13}));
  EXPECT_EQ(repeats, (std::vector<bool>{false, false, true, true, false, true, false}));
  EXPECT_EQ(ears.counters().gaps[kStateSlot], 3);
  EXPECT_EQ(ears.counters().repeats[kStateSlot], 3);
  EXPECT_EQ(ears.counters().reordered[kStateSlot], 2);
  EXPECT_EQ(ears.counters().received[kStateSlot], 7);
}

TEST(BusSequences, EverySenderAndChannelCountsForItself) {
  Bus ears(test_config());
  Bus mouth(test_config());
  for (const std::int64_t sequence : {100, 101}) {
    send_state(mouth, 1, sequence);
    send_state(mouth, 2, sequence - 100);
    truth_t truth{};
    mouth.send(Channel::kTruth, truth, {.epoch = 1, .sequence = sequence - 50});
  }
  ears.wait(kSecond);
  EXPECT_EQ(drain(ears), (std::vector<std::int64_t>{100, 0, 101, 1}));
  EXPECT_EQ(ears.counters().gaps, decltype(BusCounters::gaps){});
  EXPECT_EQ(ears.counters().reordered, decltype(BusCounters::reordered){});
}

TEST(BusSequences, ForgetsTheSenderNotHeardForLongest) {
  Bus ears(test_config());
  Bus mouth(test_config());
  send_state(mouth, 1, 10);
  send_state(mouth, 2, 10);
  send_state(mouth, 1, 11);  // now 2 is the one not heard for longest
  for (std::int64_t epoch = 3; epoch <= 17; ++epoch) send_state(mouth, epoch, 10);
  send_state(mouth, 1, 5);
  send_state(mouth, 2, 5);
  ears.wait(kSecond);
  drain(ears);
  EXPECT_EQ(ears.counters().reordered[kStateSlot], 1) << "1 is remembered, 2 is not";
  EXPECT_EQ(ears.counters().received[kStateSlot], 19);
}

TEST(BusSequences, HostileNumbersDoNotOverflow) {
  constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();
  Bus ears(test_config());
  Bus mouth(test_config());
  for (std::int64_t epoch = 0; epoch < 3; ++epoch) {
    send_state(mouth, epoch, 0);
    send_state(mouth, epoch, kHighest);
  }
  ears.wait(kSecond);
  drain(ears);
  EXPECT_EQ(ears.counters().gaps[kStateSlot], kHighest);
}

TEST(BusFlood, IsReadInPiecesOf256) {
  constexpr std::size_t kPiece = 256;
  Bus ears(test_config());
  Bus mouth(test_config());
  for (std::int64_t i = 0; i < 600; ++i) send_state(mouth, 1, i);
  ears.wait(kSecond);
  EXPECT_EQ(drain(ears).size(), kPiece);
  EXPECT_EQ(drain(ears).size(), kPiece);
  EXPECT_EQ(drain(ears).size(), 600 - 2 * kPiece);
}

TEST(BusFlood, OfRubbishIsReadInPiecesOf256) {
  Bus ears(test_config());
  RawPeer peer(test_config());
  for (int i = 0; i < 300; ++i) peer.send(Bytes{1, 2, 3});
  ears.wait(kSecond);
  EXPECT_FALSE(ears.receive());
  EXPECT_EQ(ears.counters().malformed, 256);
  EXPECT_FALSE(ears.receive());
  EXPECT_EQ(ears.counters().malformed, 300);
}

TEST(BusFlood, OfRubbishIsReadInPiecesOf256AfterMuchThatIsGood) {
  Bus ears(test_config());
  Bus mouth(test_config());
  RawPeer peer(test_config());
  for (std::int64_t i = 0; i < 300; ++i) send_state(mouth, 1, i);
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(ears.receive(kSecond));
  for (int i = 0; i < 300; ++i) peer.send(Bytes{1, 2, 3});
  EXPECT_FALSE(ears.receive(kSecond));
  EXPECT_EQ(ears.counters().malformed, 256);
}

TEST(BusFlood, WhatTheKernelDropsIsCounted) {
  Bus ears(test_config());
  Bus mouth(test_config());
  constexpr std::int64_t kSent = 20'000;  // the buffer holds about a third of it
  for (std::int64_t i = 0; i < kSent; ++i) send_state(mouth, 1, i);
  ears.wait(kSecond);
  while (!drain(ears).empty()) {
  }
  EXPECT_GT(ears.counters().kernel_dropped, 0);
  EXPECT_EQ(ears.counters().received[kStateSlot] + ears.counters().kernel_dropped, kSent);
  send_state(mouth, 1, kSent);  // behind the gap
  ASSERT_TRUE(receive_soon(ears));
  EXPECT_EQ(ears.counters().gaps[kStateSlot], ears.counters().kernel_dropped);
}

TEST(BusWait, OneARoundIsAllThatComes) {
  Bus ears(test_config());
  Bus mouth(test_config());
  for (std::int64_t i = 0; i < 600; ++i) send_state(mouth, 1, i);
  std::int64_t heard = 0;
  while (ears.receive(kSecond / 100)) ++heard;
  EXPECT_EQ(heard, 600);
}

TEST(BusWait, WaitsNoLongerThanAsked) {
  Bus bus(test_config());
  EXPECT_FALSE(bus.wait(1000));
  EXPECT_FALSE(bus.wait(0));
  EXPECT_FALSE(bus.wait(-5));
  for (const std::int64_t timeout : {1000, 0, -5}) EXPECT_FALSE(bus.receive(timeout));
}

}  // namespace
}  // namespace gyrotwin
