// liblcm, unmodified, is a peer: it reads what we send and we read what it sends. Needs a multicast
// route on `lo`: run through tests/support/in_namespace.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "services/runtime/bus.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

constexpr int kMessages = 100;

std::string url(const BusConfig& config) {
  return "udpm://" + config.group + ":" + std::to_string(config.port) + "?ttl=0";
}

/// What liblcm hears on one channel.
template <class Message>
using Inbox = std::vector<Message>;

// A function: liblcm's wrapper around member functions is miscompiled by GCC 12's
// -fsanitize=undefined.
template <class Message>
lcm::Subscription* subscribe(lcm::LCM& lcm, const std::string& channel, Inbox<Message>& inbox) {
  const auto take = [](const lcm::ReceiveBuffer*, const std::string&, const Message* message,
                       Inbox<Message>* to) { to->push_back(*message); };
  return lcm.subscribeFunction<Message, Inbox<Message>*>(channel, take, &inbox);
}

/// Lets liblcm deliver until `inbox` holds `count` messages, ten seconds at most.
template <class Message>
void deliver(lcm::LCM& lcm, const Inbox<Message>& inbox, std::size_t count) {
  for (int i = 0; i < 1000 && inbox.size() < count; ++i) lcm.handleTimeout(10);
}

TEST(LiblcmPeer, ReadsOurStates) {
  const BusConfig config = test_config();
  lcm::LCM lcm(url(config));
  ASSERT_TRUE(lcm.good());
  Inbox<state_t> inbox;
  subscribe(lcm, "TEST/LIVE/STATE", inbox)->setQueueCapacity(0);

  Bus bus(config);
  auto state = distinct<state_t>();
  std::vector<Bytes> sent;
  for (int i = 0; i < kMessages; ++i) {
    bus.send(Channel::kState, state, {.epoch = 5, .sequence = i, .tick = i, .sim_time_ns = 9});
    sent.push_back(encoded(state));
  }
  deliver(lcm, inbox, sent.size());
  ASSERT_EQ(inbox.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(encoded(inbox[i]), sent[i]);
  EXPECT_EQ(inbox[3].header.sequence, 3);
  EXPECT_EQ(inbox[3].header.rig_id, kTestRig);
}

TEST(LiblcmPeer, ReadsASignedRigWithoutTheKey) {
  const BusConfig config = test_config(test_key());
  lcm::LCM lcm(url(config));
  Inbox<status_t> inbox;
  subscribe(lcm, "TEST/INTEGRATOR/STATUS", inbox);

  Bus bus(config);
  auto status = distinct<status_t>();
  bus.send(Channel::kIntegratorStatus, status, {.epoch = 5});
  deliver(lcm, inbox, 1);
  ASSERT_EQ(inbox.size(), 1U);
  EXPECT_EQ(encoded(inbox[0]), encoded(status));
}

TEST(LiblcmPeer, CommandsAnUnsignedRig) {
  const BusConfig config = test_config();
  Bus bus(config);
  lcm::LCM lcm(url(config));
  auto command = distinct<command_t>();
  command.header.rig_id = kTestRig;
  for (int i = 0; i < kMessages; ++i) {
    command.header.sequence = i;
    ASSERT_EQ(lcm.publish("TEST/LIVE/COMMAND", &command), 0);
    const auto reception = receive_soon(bus);
    ASSERT_TRUE(reception);
    EXPECT_EQ(reception->channel, Channel::kCommand);
    command_t heard;
    Bus::decode(*reception, heard);
    EXPECT_EQ(encoded(heard), encoded(command));
  }
  EXPECT_EQ(bus.counters().received[1], kMessages);
  EXPECT_EQ(bus.counters().gaps[1], 0);
  EXPECT_EQ(bus.counters().malformed, 0);
}

TEST(LiblcmPeer, IsNotObeyedWithoutTheKey) {
  const BusConfig config = test_config(test_key());
  Bus bus(config);
  lcm::LCM lcm(url(config));
  auto command = distinct<command_t>();
  command.header.rig_id = kTestRig;
  ASSERT_EQ(lcm.publish("TEST/LIVE/COMMAND", &command), 0);
  for (int i = 0; i < 100 && bus.counters().unauthentic == 0; ++i) {
    bus.wait(kSecond / 10);
    EXPECT_FALSE(bus.receive());
  }
  EXPECT_EQ(bus.counters().unauthentic, 1);
}

TEST(LiblcmPeer, ItsFragmentsAndSelfTestAreForeign) {
  const BusConfig config = test_config();
  Bus bus(config);
  lcm::LCM lcm(url(config));
  Inbox<state_t> inbox;
  subscribe(lcm, "TEST/LIVE/STATE", inbox);  // sends the self-test

  // Two fragments, then a message to mark the end.
  const Bytes large(100'000, 1);
  ASSERT_EQ(lcm.publish("TEST/LIVE/STATE", large.data(), large.size()), 0);
  auto command = distinct<command_t>();
  command.header.rig_id = kTestRig;
  lcm.publish("TEST/LIVE/COMMAND", &command);
  const auto reception = receive_soon(bus);
  ASSERT_TRUE(reception);
  EXPECT_EQ(reception->channel, Channel::kCommand);
  EXPECT_GE(bus.counters().foreign, 3);
  EXPECT_EQ(bus.counters().malformed, 0);
}

}  // namespace
}  // namespace gyrotwin
