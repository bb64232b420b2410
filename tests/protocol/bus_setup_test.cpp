// A bus opens on the interface, group and port that the rig file names and on no other, or says
// what is missing. Needs root in a network namespace of its own: run through
// tests/support/in_namespace.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/runtime/bus.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

/// What the constructor says against a configuration.
std::string refusal(const BusConfig& config) {
  try {
    const Bus bus(config);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void run(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;  // NOLINT(bugprone-command-processor)
}

/// Others hear a bus, which hears itself too, and throws that away.
void expect_deaf_to_itself(const BusConfig& config) {
  Bus ears(config);
  Bus mouth(config);
  status_t status{};
  mouth.send(Channel::kIntegratorStatus, status, {.epoch = 1});
  EXPECT_TRUE(receive_soon(ears));
  EXPECT_TRUE(mouth.wait(10'000'000'000)) << "the kernel does hand it its own datagram";
  EXPECT_FALSE(mouth.receive());
  EXPECT_EQ(mouth.counters().received, decltype(BusCounters::received){});
}

/// A bus on `lab0`, the near end of a cable whose far end is `lab1`.
class InterfaceTest : public ::testing::Test {
 protected:
  void SetUp() override { run("ip link add lab0 type veth peer name lab1"); }
  static void plug_in() {
    run("ip link set lab0 up && ip link set lab1 up && ip address add 198.51.100.1/24 dev lab0");
  }
  void TearDown() override { run("ip link delete lab0"); }

  static BusConfig on_lab0() {
    BusConfig config = test_config();
    config.interface = "lab0";
    return config;
  }
};

TEST_F(InterfaceTest, SaysThatItIsDown) {
  const std::string text = refusal(on_lab0());
  EXPECT_TRUE(contains(text, "which is down: `ip link set lab0 up`")) << text;
  EXPECT_TRUE(contains(text, "lo, lab1, lab0")) << text;
}

TEST_F(InterfaceTest, SaysThatItHasNoAddress) {
  run("ip link set lab0 up");
  const std::string text = refusal(on_lab0());
  EXPECT_TRUE(contains(text, "no IPv4 address: `ip address add")) << text;
}

TEST_F(InterfaceTest, OneGroupOnTwoInterfacesIsTwoNetworks) {
  plug_in();
  Bus ears(on_lab0());
  Bus ears_on_lo(test_config());
  Bus mouth(on_lab0());
  Bus mouth_on_lo(test_config());
  status_t status{};
  mouth.send(Channel::kIntegratorStatus, status, {.epoch = 1});
  mouth_on_lo.send(Channel::kControllerStatus, status, {.epoch = 1});

  const auto near = receive_soon(ears);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->channel, Channel::kIntegratorStatus);
  EXPECT_FALSE(ears.receive());
  const auto local = receive_soon(ears_on_lo);
  ASSERT_TRUE(local);
  EXPECT_EQ(local->channel, Channel::kControllerStatus);
  EXPECT_FALSE(ears_on_lo.receive());
}

/// All who share an interface share its address, so what a bus said comes back to it there.
TEST_F(InterfaceTest, NobodyHearsItself) {
  plug_in();
  expect_deaf_to_itself(on_lab0());
}

TEST(BusSetup, EveryBusOnTheLoopbackInterfaceSpeaksFromItsOwnAddress) {
  constexpr std::size_t kMany = 100;
  std::set<std::pair<in_addr_t, in_port_t>> addresses;
  std::vector<MulticastSockets> open;
  for (std::size_t i = 0; i < kMany; ++i) {
    open.push_back(open_multicast("239.255.71.201", 21'201, "lo", 0, 256 << 10));
    const sockaddr_in& own = open.back().own_address;
    EXPECT_EQ(ntohl(own.sin_addr.s_addr) & 0xffff, ntohs(own.sin_port));
    addresses.insert({own.sin_addr.s_addr, own.sin_port});
  }
  EXPECT_EQ(addresses.size(), kMany);
}

/// A host may have one address on `lo`: then a bus hears itself, and throws that away.
TEST(BusSetup, WorksWithoutAddressesOfItsOwn) {
  run("ip address delete 127.0.0.1/8 dev lo && ip address add 127.0.0.1/32 dev lo");
  expect_deaf_to_itself(test_config());
  run("ip address delete 127.0.0.1/32 dev lo && ip address add 127.0.0.1/8 dev lo");
}

TEST(BusSetup, NamesTheInterfaceThatIsMissing) {
  BusConfig config = test_config();
  config.interface = "lab7";
  const std::string text = refusal(config);
  EXPECT_TRUE(contains(text, "`lab7`, which does not exist")) << text;
  EXPECT_TRUE(contains(text, "this host has: lo")) << text;
  EXPECT_TRUE(contains(text, "network.interface")) << text;
}

TEST(BusSetup, RefusesWhatIsNoMulticastAddress) {
  for (const char* group : {"", "host", "192.0.2.1", "240.0.0.1", "ff02::1", "239.1.2"}) {
    BusConfig config = test_config();
    config.group = group;
    EXPECT_TRUE(contains(refusal(config), "network.group is `")) << group;
  }
  for (const int port : {-1, 0, 65536}) {
    BusConfig config = test_config();
    config.port = port;
    EXPECT_TRUE(contains(refusal(config), "network.port is " + std::to_string(port)));
  }
  for (const int ttl : {-1, 256}) {
    BusConfig config = test_config(test_key());
    config.ttl = ttl;
    EXPECT_TRUE(contains(refusal(config), "network.ttl is " + std::to_string(ttl)));
  }
}

TEST(BusSetup, RefusesToSendUnsignedBeyondThisHost) {
  BusConfig config = test_config();
  config.ttl = 1;
  EXPECT_TRUE(contains(refusal(config), "network.sign = false")) << refusal(config);
  config.key = test_key();
  EXPECT_EQ(refusal(config), "accepted");
}

TEST(BusSetup, ChannelNamesAreOfTheAlphabetAndFit) {
  for (const std::string& prefix : {std::string(), std::string("test"), std::string("A.B"),
                                    std::string("A B"), std::string("A*"), std::string(46, 'A')}) {
    BusConfig config = test_config();
    config.prefix = prefix;
    EXPECT_TRUE(contains(refusal(config), "network.prefix is `")) << prefix;
  }
  // 45 characters, `/` and CONTROLLER/STATUS make 63.
  BusConfig config = test_config();
  config.prefix = std::string(45, 'A');
  Bus ears(config);
  Bus mouth(config);
  status_t status{};
  mouth.send(Channel::kControllerStatus, status, {});
  EXPECT_TRUE(receive_soon(ears));
}

TEST(BusSetup, RefusesAPortThatIsNotShared) {
  const BusConfig config = test_config();
  const Descriptor taken(::socket(AF_INET, SOCK_DGRAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(config.port));
  ASSERT_EQ(bind(taken.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_TRUE(contains(refusal(config), "UDP port " + std::to_string(config.port)));
  EXPECT_TRUE(contains(refusal(config), "network.port")) << refusal(config);
}

TEST(BusSetup, UnicastAndOtherGroupsDoNotReachIt) {
  BusConfig other = test_config();
  other.group = "239.195.251.251";
  Bus ears(test_config());
  Bus ears_of_other(other);  // joins on the same port
  Bus mouth_of_other(other);
  status_t status{};
  mouth_of_other.send(Channel::kIntegratorStatus, status, {});
  ASSERT_TRUE(receive_soon(ears_of_other));

  BusConfig unicast = test_config();
  unicast.group = "127.0.0.1";
  RawPeer(unicast).send(Bytes{1, 2, 3});

  Bus mouth(test_config());
  mouth.send(Channel::kControllerStatus, status, {});
  const auto reception = receive_soon(ears);
  ASSERT_TRUE(reception);
  EXPECT_EQ(reception->channel, Channel::kControllerStatus);
  EXPECT_FALSE(ears.receive());
  EXPECT_EQ(ears.counters().malformed, 0);
}

}  // namespace
}  // namespace gyrotwin
