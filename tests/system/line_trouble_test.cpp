// The line to a rig in trouble: pulled, silent, damaged, restarted, stopped. Whatever happens, the
// rig is in its safe stop within the ticks it promises, says why, and comes back by reset and arm.
#include <gtest/gtest.h>

#include "services/runtime/text.hpp"
#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;
using support::OwnerKind;

/// Ticks long enough for a busy machine: ten of them are 40 ms.
const std::vector<std::string> kSlowTicks{"loop.rate_hz=250", "loop.substeps=16"};

/// A balancing rig whose line gets into trouble two seconds after its emulator has started.
class LineTrouble : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(LineTrouble, EndsInASafeStopThatSaysWhy) {
  const auto& [trouble, why] = GetParam();
  Lab lab("prototype_b", kSlowTicks);
  lab.emulator = lab.start("rig_emulator", {"--link", lab.line(), "--trouble", trouble});
  lab.owner = lab.start("hardware", {"--device", lab.line()});
  lab.controller = lab.start("controller");
  ASSERT_EQ(lab.run("ctl", {"wait", "ready", "--timeout", "30"}), 0)
      << lab.said << lab.owner->output();
  ASSERT_EQ(lab.run("ctl", {"arm"}), 0) << lab.said << lab.owner->output();
  const status_t stopped = lab.await_status(
      [](const status_t& s) {
        return s.mode == status_t::MODE_SAFE_STOP || s.mode == status_t::MODE_FALLEN;
      },
      60.0);
  EXPECT_NE(get_text(stopped.text).find(why), std::string::npos) << get_text(stopped.text);

  // Everybody is still there, and after the trouble it balances again.
  ASSERT_TRUE(lab.owner->running()) << lab.owner->output();
  ASSERT_TRUE(lab.emulator->running()) << lab.emulator->output();
  for (int i = 0; i < 100 && lab.run("ctl", {"reset"}) != 0; ++i) {
  }
  ASSERT_TRUE(lab.until(
      [](const Reception& reception) {
        if (reception.channel != Channel::kLink) return false;
        link_t link;
        Bus::decode(reception, link);
        return link.connected != 0 && link.device_mode == status_t::MODE_HELD;
      },
      60.0));
  lab.balance_in_real_time();
}

INSTANTIATE_TEST_SUITE_P(Kinds, LineTrouble,
                         testing::Values(std::pair{"silent@6+1", "sensors"},
                                         std::pair{"halves@6+1", "sensors"},
                                         std::pair{"deaf@6+1", "the device has stopped by itself"},
                                         std::pair{"restart@6", "restarted"},
                                         std::pair{"estop@6+1", "E-stop"}),
                         [](const auto& test) {
                           const std::string name = test.param.first;
                           return name.substr(0, name.find('@'));
                         });

/// Bits that flip now and then cost their frames and nothing else.
TEST(Hardware, SurvivesFlippedBits) {
  Lab lab("prototype_b", kSlowTicks);
  lab.emulator = lab.start("rig_emulator", {"--link", lab.line(), "--trouble", "flips@0=0.0002"});
  lab.owner = lab.start("hardware", {"--device", lab.line()});
  lab.controller = lab.start("controller");
  ASSERT_EQ(lab.run("ctl", {"wait", "ready", "--timeout", "30"}), 0) << lab.said;
  ASSERT_NO_FATAL_FAILURE(lab.balance_in_real_time());
  EXPECT_TRUE(lab.until([](const Reception& reception) {
    if (reception.channel != Channel::kLink) return false;
    link_t link;
    Bus::decode(reception, link);
    return link.host_bad > 20 && link.device_bad > 20 && link.samples_missed > 10;
  }));
  lab.await_mode(status_t::MODE_RUNNING);
}

/// The other end goes away altogether, and comes back.
TEST(Hardware, OpensTheLineAgain) {
  Lab lab("prototype_b", kSlowTicks);
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons(OwnerKind::kHardware));
  ASSERT_EQ(lab.run("ctl", {"arm"}), 0) << lab.said;
  lab.emulator->signal(SIGKILL);
  const status_t stopped = lab.await_mode(status_t::MODE_SAFE_STOP);
  EXPECT_NE(stopped.text[0], 0);
  EXPECT_EQ(lab.run("ctl", {"reset"}), 0) << lab.said;
  EXPECT_EQ(lab.run("ctl", {"arm"}), 1);
  EXPECT_NE(lab.said.find("cable"), std::string::npos) << lab.said;

  lab.emulator->wait();
  lab.emulator = lab.start("rig_emulator", {"--link", lab.line()});
  ASSERT_TRUE(lab.until([](const Reception& reception) {
    if (reception.channel != Channel::kLink) return false;
    link_t link;
    Bus::decode(reception, link);
    return link.connected != 0 && link.reconnects == 1;
  }));
  lab.balance_in_real_time();
}

/// The daemon dies: the device stops by itself, and another daemon takes over.
TEST(Hardware, TheDeviceStopsWithoutItsDaemon) {
  Lab lab("prototype_b", kSlowTicks);
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons(OwnerKind::kHardware));
  ASSERT_EQ(lab.run("ctl", {"arm"}), 0) << lab.said;
  lab.owner->signal(SIGKILL);
  lab.owner->wait();
  lab.owner = lab.start("hardware", {"--device", lab.line()});
  EXPECT_TRUE(lab.until([](const Reception& reception) {
    if (reception.channel != Channel::kLink) return false;
    link_t link;
    Bus::decode(reception, link);
    return link.safe_stops == 1 && link.device_mode == status_t::MODE_HELD;
  })) << lab.emulator->output();
}

/// Its own clock says 250 Hz, ours that it is 5 % fast.
TEST(Hardware, RefusesADeviceOfAnotherRate) {
  Lab lab("prototype_b", kSlowTicks);
  lab.emulator = lab.start("rig_emulator", {"--link", lab.line(), "--clock-drift-ppm", "50000"});
  lab.owner = lab.start("hardware", {"--device", lab.line()});
  lab.controller = lab.start("controller");
  const status_t held = lab.await_status([](const status_t& s) {
    return get_text(s.text).find("loop.rate_hz is 250") != std::string::npos;
  });
  EXPECT_EQ(held.mode, status_t::MODE_HELD);
  EXPECT_EQ(lab.run("ctl", {"arm"}), 1);
  EXPECT_NE(lab.said.find("loop.rate_hz is 250"), std::string::npos) << lab.said;
}

TEST(Hardware, SaysWhatIsMissing) {
  Lab lab("prototype_b");
  EXPECT_EQ(lab.run("hardware", {}), 2);
  EXPECT_NE(lab.said.find("[hardware] device"), std::string::npos) << lab.said;
  EXPECT_EQ(lab.run("hardware", {"--device", lab.line(), "--set", "loop.clock=free"}), 2);
  EXPECT_NE(lab.said.find("loop.clock must be realtime"), std::string::npos) << lab.said;
  EXPECT_EQ(lab.run("hardware", {"--device", "/dev/null"}), 2);
  EXPECT_NE(lab.said.find("/dev/null is no terminal"), std::string::npos) << lab.said;
  EXPECT_EQ(lab.run("hardware", {"--device", lab.line(), "--baud", "12345"}), 2);
  EXPECT_NE(lab.said.find(" 115200,"), std::string::npos) << lab.said;
}

}  // namespace
}  // namespace gyrotwin
