// Lockstep over the real bus: the same bits every time, and the same as offline.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/lab.hpp"

namespace gyrotwin {
namespace {

using support::Lab;

constexpr std::int64_t kTicks = 3000;

/// STATE and COMMAND by tick, with what differs from run to run blanked (architecture: epochs,
/// sender's clock, counters and identities, signatures).
struct Recording {
  std::map<std::int64_t, state_t> states;
  std::map<std::int64_t, command_t> commands;
};

void blank(header_t& header) {
  header.epoch = 0;
  header.sender_mono_ns = 0;
}

/// @param scenario played while HELD; empty: none
Recording record(const std::string& rig, const std::string& scenario = "") {
  Lab lab(rig, {"loop.clock=lockstep"});
  Recording recording;
  lab.start_daemons();
  if (!scenario.empty()) {
    EXPECT_EQ(lab.run("disturb", {"play", scenario}), 0) << lab.said;
  }
  lab.arm();
  lab.until([&](const Reception& reception) {
    if (reception.channel == Channel::kState) {
      state_t state;
      Bus::decode(reception, state);
      blank(state.header);
      std::memset(state.mac, 0, sizeof(state.mac));
      recording.states[state.header.sequence] = state;
      return state.header.tick >= kTicks;
    }
    if (reception.channel == Channel::kCommand) {
      command_t command;
      Bus::decode(reception, command);
      blank(command.header);
      command.owner_epoch = command.writer = command.counter = 0;
      std::memset(command.mac, 0, sizeof(command.mac));
      recording.commands[command.for_tick] = command;
    }
    return false;
  });
  return recording;
}

template <class Message>
std::string bytes(const Message& message) {
  std::string text(kWireSize<Message>, '\0');
  message.encode(text.data(), 0, static_cast<int>(text.size()));
  return text;
}

template <class Message>
void expect_same(const std::map<std::int64_t, Message>& a,
                 const std::map<std::int64_t, Message>& b) {
  int compared = 0;
  for (const auto& [tick, message] : a) {
    const auto other = b.find(tick);
    if (other == b.end()) continue;  // the ear may miss one on a busy machine
    ++compared;
    ASSERT_EQ(bytes(message), bytes(other->second)) << "tick " << tick;
  }
  EXPECT_GT(compared, kTicks / 2);
}

/// Offline, the same rig file and law, and what else is given.
void expect_offline(const Recording& live, const std::string& rig,
                    const std::vector<std::string>& more = {}) {
  Lab lab(rig, {"loop.clock=lockstep"});
  const model::Machine machine = lab.rig.build_machine();
  const std::string csv = (lab.folder() / "offline.csv").string();
  const double dt = lab.rig.loop.tick_s();
  std::vector<std::string> arguments{
      "--feedback", "sampled",          "--duration", std::to_string(kTicks * dt),
      "--sample",   std::to_string(dt), "--output",   csv};
  arguments.insert(arguments.end(), more.begin(), more.end());
  ASSERT_EQ(lab.run("simulate", arguments), 0) << lab.said;
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  int compared = 0;
  for (std::int64_t tick = 0; std::getline(file, line); ++tick) {
    const auto state = live.states.find(tick + 1);
    if (state == live.states.end()) continue;
    std::istringstream row(line);
    std::string cell;
    std::getline(row, cell, ',');
    std::vector<double> values;
    while (std::getline(row, cell, ',')) values.push_back(std::stod(cell));
    const int n = machine.coordinates();
    ASSERT_EQ(values.size(), static_cast<std::size_t>(2 * n));
    const model::State expected =
        machine.state({values.begin(), values.begin() + n}, {values.begin() + n, values.end()});
    model::Observation seen = machine.observe(expected);
    EXPECT_EQ(0, std::memcmp(seen.tilt.data(), state->second.tilt_rad, sizeof(seen.tilt))) << tick;
    EXPECT_EQ(seen.disc_rate, state->second.disc_rate_rad_s) << tick;
    EXPECT_EQ(0, std::memcmp(seen.gimbal_rate.data(), state->second.gimbal_rate_rad_s,
                             sizeof(seen.gimbal_rate)))
        << tick;
    ++compared;
  }
  EXPECT_GT(compared, kTicks / 2);
}

class Lockstep : public testing::TestWithParam<const char*> {};

TEST_P(Lockstep, IsTheSameToTheBitFromRunToRunAndOffline) {
  const Recording a = record(GetParam());
  const Recording b = record(GetParam());
  ASSERT_FALSE(a.states.empty());
  expect_same(a.states, b.states);
  expect_same(a.commands, b.commands);

  expect_offline(a, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Rigs, Lockstep,
                         testing::Values("prototype_b", "prototype_b_sleeping", "double_brennan"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Lockstep, AScenarioPlayedWhileHeldIsTheOneOfSimulate) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("gyrotwin-scenario-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << R"(
[[event]]
kind = "gust"
at_s = 0
roll_nm = 0.2
pitch_nm = 0.1
seed = 4
duration_s = 1.5
[[event]]
kind = "impulse"
at_s = 0.5
[[event]]
kind = "link"
at_s = 1.2
duration_s = 0.008
[[event]]
kind = "rotor"
rotor = 1
at_s = 2.0
drag_nm = 0.02
)";
  const Recording live = record("double_brennan", file.string());
  ASSERT_FALSE(live.states.empty());
  expect_offline(live, "double_brennan", {"--scenario", file.string()});
  std::filesystem::remove(file);
}

TEST(Lockstep, WaitsForItsControllerSaysSoAndGoesOn) {
  Lab lab("double_brennan", {"loop.clock=lockstep"});
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.arm());
  lab.controller->signal(SIGSTOP);
  const status_t waiting = lab.await_mode(status_t::MODE_PAUSED);
  EXPECT_STREQ(reinterpret_cast<const char*>(waiting.text), "waiting for controller");
  lab.controller->signal(SIGCONT);
  const status_t running = lab.await_mode(status_t::MODE_RUNNING);
  EXPECT_GE(running.header.tick, waiting.header.tick);

  // Another one takes over where the first died.
  lab.controller->signal(SIGKILL);
  lab.await_mode(status_t::MODE_PAUSED);
  lab.controller = lab.start("controller");
  lab.await_mode(status_t::MODE_RUNNING);
}

TEST(Lockstep, GoesOnAfterSingleSteps) {
  Lab lab("double_brennan", {"loop.clock=lockstep"});
  ASSERT_NO_FATAL_FAILURE(lab.start_daemons());
  ASSERT_NO_FATAL_FAILURE(lab.arm());
  ASSERT_EQ(lab.run("ctl", {"pause"}), 0) << lab.said;
  const std::int64_t paused_at = lab.await_mode(status_t::MODE_PAUSED).header.tick;
  for (const std::int64_t ticks : {5, 10}) {
    ASSERT_EQ(lab.run("ctl", {"step", "5"}), 0) << lab.said;
    const status_t status = lab.await_status([&](const status_t& s) {
      return s.mode == status_t::MODE_PAUSED && s.header.tick >= paused_at + ticks;
    });
    EXPECT_EQ(status.header.tick, paused_at + ticks);
  }
  ASSERT_EQ(lab.run("ctl", {"resume"}), 0) << lab.said;
  lab.await_status([&](const status_t& s) { return s.header.tick > paused_at + 1000; });
}

}  // namespace
}  // namespace gyrotwin
