// The gateway on a running rig: Foxglove's own client reads and pushes it, and who means harm is
// refused.
#include <gtest/gtest.h>

#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using support::Process;

/// A rig that balances, its gateway, and what node says of it.
class GatewaySystem : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(lab_.start_daemons());
    ASSERT_NO_FATAL_FAILURE(lab_.balance());
    gateway_ = lab_.start("gateway", {"--recordings", lab_.folder() / "recordings"});
    const bool shows = lab_.until([](const Reception& heard) {
      if (heard.channel != Channel::kGatewayStatus) return false;
      status_t status;
      Bus::decode(heard, status);
      return status.mode == status_t::MODE_ACTIVE;
    });
    ASSERT_TRUE(shows) << gateway_->output();
    ASSERT_EQ(lab_.run("gateway", {"--urls"}), 0) << lab_.said;
    ::setenv("GATEWAY_OPERATOR", address("operator").c_str(), 1);
    ::setenv("GATEWAY_OBSERVER", address("observer").c_str(), 1);
  }

  std::string address(const std::string& role) const {
    const std::size_t begin = lab_.said.find("http", lab_.said.find(role));
    return lab_.said.substr(begin, lab_.said.find('\n', begin) - begin);
  }

  void node(const std::string& tests) {
    Process peer({"/usr/bin/env", "node", "--test", GYROTWIN_GATEWAY_PEER "/" + tests},
                 lab_.folder() / tests);
    EXPECT_EQ(peer.wait(), 0) << peer.output() << gateway_->output();
    // Whatever was said to it, it goes on.
    EXPECT_TRUE(lab_.until([](const Reception& heard) {
      return heard.channel == Channel::kGatewayStatus && !heard.repeat;
    }));
  }

  Lab lab_{"prototype_b"};
  std::unique_ptr<Process> gateway_;
};

TEST_F(GatewaySystem, FoxglovesOwnClientReadsAndPushes) { node("peer.test.mjs"); }

TEST_F(GatewaySystem, WhoMeansHarmIsRefusedAndNobodyElseNotices) { node("hostile.test.mjs"); }

}  // namespace
}  // namespace gyrotwin
