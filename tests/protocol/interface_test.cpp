// The interface that a rig file names is the one that is used, and what it lacks is said. Needs
// root in a network namespace of its own: run through tests/support/in_namespace.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "services/runtime/bus.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

void run(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;  // NOLINT(bugprone-command-processor)
}

/// A bus on `lab0`, the near end of a cable whose far end is `lab1`.
class InterfaceTest : public ::testing::Test {
 protected:
  void SetUp() override { run("ip link add lab0 type veth peer name lab1"); }
  void TearDown() override { run("ip link delete lab0"); }

  static BusConfig on_lab0() {
    BusConfig config = test_config();
    config.interface = "lab0";
    return config;
  }

  static std::string refusal(const BusConfig& config) {
    try {
      const Bus bus(config);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(InterfaceTest, SaysThatItIsDown) {
  const std::string text = refusal(on_lab0());
  EXPECT_NE(text.find("which is down: `ip link set lab0 up`"), std::string::npos) << text;
  EXPECT_NE(text.find("lo, lab1, lab0"), std::string::npos) << text;
}

TEST_F(InterfaceTest, SaysThatItHasNoAddress) {
  run("ip link set lab0 up");
  const std::string text = refusal(on_lab0());
  EXPECT_NE(text.find("no IPv4 address: `ip address add"), std::string::npos) << text;
}

TEST_F(InterfaceTest, OneGroupOnTwoInterfacesIsTwoNetworks) {
  run("ip link set lab0 up && ip link set lab1 up && ip address add 198.51.100.1/24 dev lab0");
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

}  // namespace
}  // namespace gyrotwin
