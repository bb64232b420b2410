// A running system for a test: daemons as processes, the front command, and an ear on the bus.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <memory>
#include <string>

#include "tests/support/programs.hpp"

namespace gyrotwin::support {

/// Who owns the plant.
enum class OwnerKind { kIntegrator, kHardware };

/// One rig's processes and its bus. Runs in a network namespace of the test's own.
class Lab : public Programs {
 public:
  explicit Lab(const std::string& rig_name, Words overrides = {})
      : Programs(rig_name, std::move(overrides)),
        bus(std::make_unique<Bus>(bus_config(rig, header_t::OPERATOR))) {}

  /// A simulated plant, or hardware on a line to an emulated rig.
  void start_owner(OwnerKind kind = OwnerKind::kIntegrator) {
    if (kind == OwnerKind::kIntegrator) {
      owner = start("integrator");
      return;
    }
    emulator = start("rig_emulator", {"--link", line()});
    owner = start("hardware", {"--device", line()});
  }

  void start_daemons(OwnerKind kind = OwnerKind::kIntegrator) {
    start_owner(kind);
    controller = start("controller");
    ASSERT_EQ(run("ctl", {"wait", "ready", "--timeout", "30"}), 0)
        << said << owner->output() << controller->output();
  }

  /// Slowed down, so that a busy machine's pauses are short in the owner's time.
  void balance(double speed = 0.25) {
    if (rig.loop.clock == ClockMode::kRealtime) {
      ASSERT_EQ(run("ctl", {"speed", std::to_string(speed)}), 0) << said;
    }
    arm();
    ASSERT_EQ(run("ctl", {"wait", "balanced", "--timeout", "60"}), 0)
        << said << owner->output() << controller->output();
  }

  /// At full speed, as hardware must: where the machine paused for longer than the timeout, and the
  /// owner has stopped safely, once more, as an operator would.
  void balance_in_real_time() {
    for (int attempt = 0; attempt < 3; ++attempt) {
      if (attempt > 0) {
        ASSERT_EQ(run("ctl", {"reset"}), 0) << said;
      }
      ASSERT_NO_FATAL_FAILURE(arm());
      if (run("ctl", {"wait", "balanced", "--timeout", "60"}) == 0) return;
    }
    FAIL() << said << owner->output() << controller->output();
  }

  void arm() {
    ASSERT_EQ(run("ctl", {"wait", "ready", "--timeout", "30"}), 0) << said;
    ASSERT_EQ(run("ctl", {"arm"}), 0) << said;
  }

  /// Hands receptions to `done` until it returns true. @return false after `limit_s` of wall time
  template <class Done>
  bool until(Done&& done, double limit_s = 30.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
    while (std::chrono::steady_clock::now() < end) {
      while (const auto reception = bus->receive()) {
        if (done(*reception)) return true;
      }
      bus->wait(10'000'000);
    }
    return false;
  }

  /// Waits for a STATUS of the owner that satisfies `holds`, and returns the last one heard.
  template <class Holds>
  status_t await_status(Holds&& holds, double limit_s = 30.0) {
    status_t status{};
    const bool came = until(
        [&](const Reception& reception) {
          if (!is_owner_status(reception.channel)) return false;
          Bus::decode(reception, status);
          return holds(status);
        },
        limit_s);
    EXPECT_TRUE(came) << "mode " << status.mode << " " << status.text;
    return status;
  }
  status_t await_mode(std::int32_t mode, double limit_s = 30.0) {
    return await_status([mode](const status_t& s) { return s.mode == mode; }, limit_s);
  }

  /// Kills the controller of a running rig. @return ticks from its last COMMAND to the one in which
  /// the owner stops safely
  std::int64_t ticks_to_safe_stop() {
    controller->signal(SIGKILL);
    std::int64_t last_command = -1, first_stopped = -1;
    EXPECT_TRUE(until([&](const Reception& reception) {
      if (reception.channel == Channel::kCommand) {
        command_t command;
        Bus::decode(reception, command);
        last_command = command.for_tick;
      } else if (reception.channel == Channel::kState) {
        state_t state;
        Bus::decode(reception, state);
        if (state.mode == status_t::MODE_SAFE_STOP) first_stopped = state.header.tick;
      }
      return first_stopped >= 0;
    }));
    EXPECT_GE(last_command, 0);
    // The STATE that says so closes the tick that began with the decision.
    return first_stopped - 1 - last_command;
  }

  /// Path of the line to the emulated rig.
  std::string line() const { return (folder() / "line").string(); }

  std::unique_ptr<Bus> bus;
  std::unique_ptr<Process> controller, emulator, owner;  // ended from the last to the first
};

}  // namespace gyrotwin::support
