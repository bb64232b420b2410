// Rows about the network between the hosts.
#include "services/runtime/text.hpp"
#include "tests/faults/fixture.hpp"

namespace gyrotwin::faults {

namespace {

constexpr const char* kAsEver = "RUNNING; `ctl` is answered";

}  // namespace

TEST_F(Patient, LossOf5Percent) {
  row("5 % of all datagrams lost", "balances on", kAsEver, kNothing);
  hosts().wire.set({.loss = 0.05});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
  const status_t status = owner_status();
  EXPECT_GT(status.gaps[static_cast<std::size_t>(Channel::kCommand)], 0) << "counted";
}

TEST_F(Patient, LossOf30PercentAndEveryRequestIsDoneOnce) {
  row("30 % of all datagrams lost", "balances on",
      "RUNNING; ten of ten `disturb step` answered, each applied exactly once", kNothing);
  hosts().wire.set({.loss = 0.3});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  constexpr int kRequests = 10;
  for (int i = 1; i <= kRequests; ++i) {
    // Each stays, so that they can be counted.
    ASSERT_EQ(hosts().ask("disturb", {"step", "--roll", "0.001"}), 0) << hosts().said;
    EXPECT_EQ(owner_status().disturbances, i) << hosts().said;
  }
  ASSERT_EQ(hosts().ask("disturb", {"clear"}), 0) << hosts().said;
  EXPECT_EQ(owner_status().disturbances, 0);
}

TEST_F(Patient, DelayOf2Milliseconds) {
  row("2 ms of delay each way (1/8 tick)", "balances on", kAsEver, kNothing);
  hosts().wire.set({.delay_s = 0.002});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
}

TEST_F(Patient, DelayOf20MillisecondsWithJitter) {
  row("20 ms +- 10 ms of delay each way (2 to 4 ticks there and back)", "balances on", kAsEver,
      kNothing);
  hosts().wire.set({.delay_s = 0.020, .jitter_s = 0.010});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
}

TEST_F(Strict, DelayLongerThanTheTimeout) {
  row("250 ms of delay each way (31 ticks there and back)", "SAFE_STOP", kLost, kResetAndArm);
  hosts().wire.set({.delay_s = 0.25});
  ASSERT_NO_FATAL_FAILURE(stops_safely());
}

TEST_F(Patient, Reordering) {
  row("25 % of all datagrams overtaken, by 40 ms", "balances on; what is older is dropped",
      "RUNNING; `ctl status`: \"came too late\"", kNothing);
  hosts().wire.set({.overtaken = 0.25, .overtaken_s = 0.040});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "came too late"));
}

TEST_F(Patient, Duplication) {
  row("every datagram comes twice", "balances on; a request is done once",
      "RUNNING; `ctl status`: \"with a used counter\"", kNothing);
  hosts().wire.set({.duplicated = 1.0});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_EQ(hosts().ask("disturb", {"step", "--roll", "0.001"}), 0) << hosts().said;
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "with a used counter"));
  EXPECT_EQ(owner_status().disturbances, 1);
  ASSERT_EQ(hosts().ask("disturb", {"clear"}), 0) << hosts().said;
}

TEST_F(Patient, NarrowNetwork) {
  row("1 Mbit/s, a queue of 100 ms", "balances on", kAsEver, kNothing);
  hosts().wire.set({.rate_bit_s = 1e6});
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
}

TEST_F(Strict, NetworkTooNarrow) {
  row("50 kbit/s, a queue of 300 ms", "SAFE_STOP", kLost, kResetAndArm);
  hosts().wire.set({.rate_bit_s = 5e4, .longest_queue_s = 0.3});
  ASSERT_NO_FATAL_FAILURE(stops_safely());
}

TEST_F(Strict, ControllersCableOut) {
  row("the controller's cable out, and in again", "SAFE_STOP, then it falls",
      std::string(kLost) + "; later: fell after the stop: ...", kResetAndArm);
  hosts().wire.cut(Hosts::kControllers, true);
  ASSERT_NO_FATAL_FAILURE(stops_safely());
  EXPECT_TRUE(hosts().operator_ear.owner_status([](const status_t& status) {
    return status.mode == status_t::MODE_FALLEN &&
           get_text(status.text) == std::string("fell after the stop: ") + kLost;
  }));
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "controller  not heard"));
}

TEST_F(Strict, PlantsCableOut) {
  row("the plant's cable out, and in again", "SAFE_STOP",
      "nothing is heard: `ctl` says \"no owner of rig double_brennan is heard\"; then \"no valid "
      "command in time\"",
      kResetAndArm);
  hosts().wire.cut(Hosts::kPlant, true);
  const auto stopped = hosts().plant_ear.owner_status(
      [](const status_t& s) { return s.mode != status_t::MODE_RUNNING; });
  ASSERT_TRUE(stopped);
  ASSERT_NO_FATAL_FAILURE(asks({"disarm"}, 1, "no owner of rig double_brennan is heard"));
  hosts().wire.cut(Hosts::kPlant, false);
  ASSERT_NO_FATAL_FAILURE(stops_safely());
}

TEST_F(Strict, OperatorsCableOut) {
  row("the operator's cable out, and in again", "balances on",
      "`ctl`: \"no owner of rig double_brennan is heard\"; then as ever", kNothing);
  hosts().wire.cut(Hosts::kOperators, true);
  ASSERT_NO_FATAL_FAILURE(asks({"disarm"}, 1, "no owner of rig double_brennan is heard"));
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  hosts().wire.cut(Hosts::kOperators, false);
  ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
}

TEST_F(Strict, ControllersInterfaceDown) {
  row("the controller's interface down, and up again", "SAFE_STOP", kLost, kResetAndArm);
  hosts().controllers.shell("ip link set eth0 down");
  ASSERT_NO_FATAL_FAILURE(stops_safely());
  hosts().controllers.shell("ip link set eth0 up");
}

}  // namespace gyrotwin::faults
