// Rows about daemons and their hosts: frozen, killed, with another time of day, out of room.
#include <signal.h>

#include <fstream>
#include <sstream>

#include "services/runtime/text.hpp"
#include "tests/faults/fixture.hpp"

namespace gyrotwin::faults {

namespace {

constexpr int kKills = 3;  // of each daemon

Words matching_lines(const std::string& text, const std::string& word) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.find(word) != std::string::npos) lines.push_back(line);
  }
  return lines;
}

/// Waits for a STATUS of a listener.
bool heard_of(Hosts& hosts, Channel status) {
  return hosts.operator_ear.until([status](const Heard& h) { return h.channel == status; });
}

}  // namespace

TEST_F(Strict, ControllersHostFrozen) {
  row("the controller's host frozen (SIGSTOP), and running again", "SAFE_STOP", kLost,
      kResetAndArm);
  hosts().controller->signal(SIGSTOP);
  EXPECT_NO_FATAL_FAILURE(stops_safely());
  hosts().controller->signal(SIGCONT);
}

TEST_F(Strict, PlantsHostFrozen) {
  row("the simulated plant's host frozen, and running again",
      "its time stands still; then it balances on",
      "nothing is heard: `ctl` says \"no owner of rig double_brennan is heard\"; then as ever",
      kNothing);
  hosts().owner->signal(SIGSTOP);
  EXPECT_NO_FATAL_FAILURE(asks({"disarm"}, 1, "no owner of rig double_brennan is heard"));
  hosts().owner->signal(SIGCONT);
  ASSERT_NO_FATAL_FAILURE(keeps_balancing());
  EXPECT_GT(owner_status().overruns, 0) << "the lost time is counted";
}

TEST_F(Strict, ControllerKilled) {
  row("the controller killed, at three random times", "SAFE_STOP", kLost, kStartResetAndArm);
  for (int i = 0; i < kKills; ++i) {
    ASSERT_NO_FATAL_FAILURE(bring_back());
    ASSERT_NO_FATAL_FAILURE(some_ticks_pass());
    hosts().controller->signal(SIGKILL);
    ASSERT_NO_FATAL_FAILURE(stops_safely());
    hosts().controller->wait();
  }
}

TEST_F(Strict, OwnerKilled) {
  row("the simulated plant killed, at three random times", "its time is over; anew it is HELD",
      "`ctl`: \"no owner of rig double_brennan is heard\"; controller: \"start "
      "gyrotwin-integrator\"",
      kStartResetAndArm);
  for (int i = 0; i < kKills; ++i) {
    ASSERT_NO_FATAL_FAILURE(bring_back());
    ASSERT_NO_FATAL_FAILURE(some_ticks_pass());
    hosts().owner->signal(SIGKILL);
    hosts().owner->wait();
    const bool told = hosts().operator_ear.until([](const Heard& heard) {
      if (heard.channel != Channel::kControllerStatus) return false;
      return get_text(heard.as<status_t>().text).find("start gyrotwin-integrator") !=
             std::string::npos;
    });
    ASSERT_TRUE(told);
    ASSERT_NO_FATAL_FAILURE(asks({"arm"}, 1, "no owner of rig double_brennan is heard"));
    hosts().start_owner();
    const auto again = hosts().operator_ear.owner_status([](const status_t&) { return true; });
    ASSERT_TRUE(again);
    EXPECT_EQ(again->mode, status_t::MODE_HELD) << "whatever commands still come";
  }
}

TEST_F(Strict, MirrorKilled) {
  row("the mirror killed, at three random times", "balances on", "`ctl status` tells no mirror",
      kNothing);
  for (int i = 0; i < kKills; ++i) {
    const auto mirror = hosts().start("mirror", {}, hosts().controllers.launcher());
    ASSERT_TRUE(heard_of(hosts(), Channel::kTwinState)) << mirror->output();
    ASSERT_NO_FATAL_FAILURE(some_ticks_pass());
    mirror->signal(SIGKILL);
    mirror->wait();
    ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
    ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
    EXPECT_EQ(told_.find("mirror "), std::string::npos) << told_;
  }
}

TEST_F(Strict, MirrorKilledUnderAController) {
  row("the mirror killed while the controller is `--on twin`", "SAFE_STOP",
      "controller: \"no TWIN/STATE is heard, so no commands: start gyrotwin-mirror\"",
      kStartResetAndArm);
  const auto mirror = hosts().start("mirror", {}, hosts().controllers.launcher());
  hosts().controller->signal(SIGKILL);
  hosts().controller->wait();
  ASSERT_NO_FATAL_FAILURE(stops_safely());
  hosts().start_controller({"--on", "twin"});
  ASSERT_NO_FATAL_FAILURE(bring_back());
  ASSERT_NO_FATAL_FAILURE(some_ticks_pass());
  mirror->signal(SIGKILL);
  ASSERT_NO_FATAL_FAILURE(stops_safely());
  EXPECT_TRUE(hosts().operator_ear.until([](const Heard& heard) {
    if (heard.channel != Channel::kControllerStatus) return false;
    return get_text(heard.as<status_t>().text) ==
           "no TWIN/STATE is heard, so no commands: start gyrotwin-mirror";
  }));
  hosts().controller->signal(SIGKILL);  // another takes its place
  hosts().controller->wait();
}

TEST_F(Strict, GatewayKilled) {
  row("the gateway killed, at three random times", "balances on", "RUNNING; `ctl` is answered",
      kNothing);
  for (int i = 0; i < kKills; ++i) {
    const auto gateway = hosts().start("gateway", {}, hosts().at_operator.launcher());
    ASSERT_TRUE(heard_of(hosts(), Channel::kGatewayStatus)) << gateway->output();
    ASSERT_NO_FATAL_FAILURE(some_ticks_pass());
    gateway->signal(SIGKILL);
    gateway->wait();
    ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
    ASSERT_NO_FATAL_FAILURE(asks({"status"}, 0, "RUNNING"));
  }
}

TEST_F(Patient, DiskFull) {
  row("the recorder's disk full", "balances on",
      "`log record` ends with code 1 and \"No space left on device\"; `log info` reads all that it "
      "had written",
      kNothing);
  const auto disk = hosts().folder() / "disk", kept = hosts().folder() / "kept.lcm";
  std::filesystem::create_directory(disk);
  Words launcher = hosts().at_operator.launcher();
  // In a mount namespace of its own; what is on that disk is gone with it.
  launcher.insert(launcher.end(), {"/usr/bin/unshare", "-m", "sh", "-c",
                                   "mount -t tmpfs -o size=512k none " + disk.string() +
                                       " && { \"$@\"; code=$?; cp " + disk.string() + "/run.lcm " +
                                       kept.string() + "; exit $code; }",
                                   "sh"});
  const int code = hosts().run("log", {"record", (disk / "run.lcm").string()}, launcher);
  EXPECT_EQ(code, 1) << hosts().said;
  EXPECT_NE(hosts().said.find("No space left on device"), std::string::npos) << hosts().said;
  ASSERT_NO_FATAL_FAILURE(keeps_balancing(50));
  Process info({std::string(GYROTWIN_BIN) + "/gyrotwin-log", "info", kept.string()},
               hosts().folder() / "info.txt");
  EXPECT_EQ(info.wait(), 0) << info.output();
  EXPECT_NE(info.output().find("LIVE/STATE"), std::string::npos) << info.output();
}

TEST_F(Patient, WallClockStepped) {
  row("the time of day stepped by +1 h, then by -2 h, on every host", "balances on",
      "RUNNING; only the log lines' times leap", kNothing);
  // Ours to set: the daemons get it from a shim, the machine's clock stays.
  const auto clock = hosts().folder() / "clock";
  const auto set_hours = [&clock](std::int64_t hours) {
    const std::int64_t seconds = 3600 * hours;
    std::fstream file(clock, std::ios::in | std::ios::out | std::ios::binary);
    if (!file) file.open(clock, std::ios::out | std::ios::binary);
    file.write(reinterpret_cast<const char*>(&seconds), sizeof seconds);
  };
  set_hours(0);
  hosts().environment = {"/usr/bin/env", std::string("LD_PRELOAD=") + GYROTWIN_WALL_CLOCK_SHIM,
                         "GYROTWIN_TEST_CLOCK=" + clock.string()};
  for (auto* daemon : {&hosts().owner, &hosts().controller}) {
    (*daemon)->signal(SIGKILL);
    (*daemon)->wait();
  }
  ASSERT_NO_FATAL_FAILURE(bring_back());
  hosts().environment.clear();
  // What the owner writes into its log shows that the clock did leap.
  int refusals = 0;
  const auto hour_of_refusal = [&] {
    EXPECT_EQ(hosts().ask("ctl", {"step", "1"}), 1) << "only PAUSED";
    ++refusals;
    std::string hour;
    EXPECT_TRUE(hosts().plant_ear.until([&](const Heard&) {
      const Words lines = matching_lines(hosts().owner->output(), "step: refused");
      if (static_cast<int>(lines.size()) < refusals) return false;  // written a little later
      hour = lines.back().substr(0, std::string_view("2026-01-31 21").size());
      return true;
    }));
    return hour;
  };
  const std::string before = hour_of_refusal();
  for (const int hours : {1, -1}) {
    set_hours(hours);
    ASSERT_NO_FATAL_FAILURE(keeps_balancing());
    EXPECT_NE(hour_of_refusal(), before);
  }
}

TEST_F(Hardware, ControllersCableOut) {
  row("a real rig: the controller's cable out, and in again", "SAFE_STOP", kLost, kResetAndArm);
  hosts().wire.cut(Hosts::kControllers, true);
  ASSERT_NO_FATAL_FAILURE(stops_safely());
}

/// Safe stops that the device has made by itself, as its daemon tells.
std::int64_t safe_stops(Hosts& hosts) {
  std::int64_t count = -1;
  EXPECT_TRUE(hosts.plant_ear.until([&count](const Heard& heard) {
    if (heard.channel != Channel::kLink) return false;
    const auto link = heard.as<link_t>();
    count = link.safe_stops;
    return link.connected != 0;
  }));
  return count;
}

TEST_F(Hardware, DaemonsHostFrozen) {
  row("a real rig: its daemon's host frozen, and running again", "the device stops by itself",
      "`ctl`: \"no owner of rig prototype_b is heard\"; then \"no valid command in time\"",
      kResetAndArm);
  const std::int64_t before = safe_stops(hosts());
  hosts().owner->signal(SIGSTOP);
  EXPECT_NO_FATAL_FAILURE(asks({"disarm"}, 1, "no owner of rig prototype_b is heard"));
  hosts().owner->signal(SIGCONT);
  ASSERT_NO_FATAL_FAILURE(stops_safely());
  EXPECT_EQ(safe_stops(hosts()), before + 1);
}

TEST_F(Hardware, DaemonKilled) {
  row("a real rig: its daemon killed", "the device stops by itself; the new daemon is HELD",
      "`ctl`: \"no owner of rig prototype_b is heard\"", kStartResetAndArm);
  const std::int64_t before = safe_stops(hosts());
  hosts().owner->signal(SIGKILL);
  hosts().owner->wait();
  ASSERT_NO_FATAL_FAILURE(asks({"disarm"}, 1, "no owner of rig prototype_b is heard"));
  hosts().start_owner(true);
  EXPECT_EQ(safe_stops(hosts()), before + 1);
  EXPECT_EQ(owner_status().mode, status_t::MODE_HELD);
}

}  // namespace gyrotwin::faults
