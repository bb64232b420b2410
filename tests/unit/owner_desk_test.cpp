// What an owner says about others who claim its rig.
#include "services/runtime/owner_desk.hpp"

#include <gtest/gtest.h>

#include "services/integrator/integrator.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

/// An owner that is HELD, its desk, and another owner on the same bus.
struct Desk {
  Desk() : bus(test_config()), other(test_config()), ear(test_config()) {}

  /// What the other one sends, to the desk.
  template <class Message>
  void hear(Channel channel, Message message, std::int64_t now) {
    other.send(channel, message, {.epoch = 7, .sequence = ++sequence, .tick = 0, .sim_time_ns = 0});
    const auto reception = receive_soon(bus);
    ASSERT_TRUE(reception);
    desk.hear(*reception, now);
  }
  std::string says(std::int64_t now) {
    status_t status{};
    integrator.fill(status);
    desk.send_status(status, now);
    return get_text(status.text);
  }

  Rig rig = load_rig("prototype_b");
  Bus bus, other, ear;
  Daemon daemon{"owner_desk_test"};
  Integrator integrator{rig, 1};
  OwnerDesk desk{bus, daemon, integrator, Channel::kIntegratorStatus};
  std::int64_t sequence = 0;
};

TEST(OwnerDesk, SaysThatNoControllerIsHeard) {
  Desk d;
  EXPECT_EQ(d.says(kSecond), "no controller is heard");
  d.hear(Channel::kControllerStatus, status_t{}, 2 * kSecond);
  EXPECT_EQ(d.says(2 * kSecond), "");
  EXPECT_EQ(d.says(3 * kSecond), "no controller is heard");
}

TEST(OwnerDesk, NamesAnotherOwnerForAsLongAsItIsHeard) {
  Desk d;
  d.hear(Channel::kState, state_t{}, kSecond);
  EXPECT_EQ(d.says(kSecond),
            "conflict: another owner publishes this rig's STATE; stop one of the two");
  status_t status{};
  status.pid = 4711;
  set_text(status.host, "lab");
  d.hear(Channel::kHardwareStatus, status, kSecond + 1);
  const char* named = "conflict: process 4711 on lab owns this rig too; stop one of the two";
  EXPECT_EQ(d.says(kSecond + 1), named);
  d.hear(Channel::kState, state_t{}, kSecond + 2);
  EXPECT_EQ(d.says(kSecond + 2), named) << "known by now";
  EXPECT_EQ(d.says(3 * kSecond), "no controller is heard");
}

}  // namespace
}  // namespace gyrotwin
