#include "tests/faults/fixture.hpp"

#include <cmath>

#include "services/runtime/mode.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::faults {

namespace {

constexpr const char* kSpeed = "0.25";
constexpr double kUpright = 0.035;  // [rad] 2 degrees

bool stopped(const status_t& status) {
  return status.mode == status_t::MODE_SAFE_STOP || status.mode == status_t::MODE_FALLEN;
}

}  // namespace

std::unique_ptr<Hosts> Faults::hosts_;
Faults::Setup Faults::hosts_setup_;

void Faults::SetUp() {
  if (!hosts_ || hosts_setup_ != setup_) {
    hosts_.reset();
    hosts_ = std::make_unique<Hosts>(setup_.rig, setup_.overrides);
    hosts_setup_ = setup_;
  }
  ASSERT_NO_FATAL_FAILURE(bring_back());
  hosts().plant_ear.forget();
  hosts().operator_ear.forget();
  ASSERT_NO_FATAL_FAILURE(some_ticks_pass(20));  // the last command before the fault is heard, too
}

void Faults::row(std::string fault, std::string does, std::string told, std::string back) {
  row_ = {std::move(fault), std::move(does), "", std::move(told), std::move(back)};
}

void Faults::TearDown() {
  if (HasFatalFailure()) {
    hosts_.reset();  // nothing of it is known
    return;
  }
  if (row_.back != kStartResetAndArm) {
    EXPECT_TRUE(hosts().owner->running()) << "died: " << hosts().owner->output();
    EXPECT_TRUE(hosts().controller->running()) << "died: " << hosts().controller->output();
  }
  if (row_.back == kNothing) {
    EXPECT_EQ(owner_status().mode, status_t::MODE_RUNNING);
  }
  bring_back();
  judge();
  if (HasFailure()) {
    hosts_.reset();
    return;
  }
  table().add(row_);
}

/// As an operator would.
void Faults::bring_back() {
  hosts().wire.set({});
  for (const auto port : {Hosts::kPlant, Hosts::kControllers, Hosts::kOperators}) {
    hosts().wire.cut(port, false);
  }
  if (!hosts().owner || !hosts().owner->running()) hosts().start_owner(setup_.hardware);
  if (!hosts().controller || !hosts().controller->running()) hosts().start_controller();
  const auto status = hosts().operator_ear.owner_status([](const status_t&) { return true; });
  ASSERT_TRUE(status) << hosts().owner->output();
  if (status->mode != status_t::MODE_RUNNING) {
    if (status->mode != status_t::MODE_HELD) {
      ASSERT_NO_FATAL_FAILURE(asks({"reset"}, 0));
    }
    ASSERT_NO_FATAL_FAILURE(asks({"wait", "ready", "--timeout", "30"}, 0));
    if (!setup_.hardware) {
      ASSERT_NO_FATAL_FAILURE(asks({"speed", kSpeed}, 0));
    }
    ASSERT_NO_FATAL_FAILURE(asks({"arm"}, 0));
  }
  ASSERT_NO_FATAL_FAILURE(asks({"wait", "balanced", "--for", "0.2", "--timeout", "30"}, 0))
      << hosts().owner->output() << hosts().controller->output();
}

void Faults::judge() {
  Judge judge(hosts().rig.safety.command_timeout_ticks);
  for (const Heard& heard : hosts().plant_ear.record()) judge.hear(heard);
  for (const std::string& complaint : judge.complaints()) ADD_FAILURE() << complaint;
  const Ticks& ticks = judge.ticks();
  row_.ticks = ticks.to_stop >= 0 ? fmt::format("{}", ticks.to_stop)
                                  : fmt::format("at most {} without", ticks.longest);
}

void Faults::some_ticks_pass(std::int64_t most) {
  const std::int64_t half = most / 2;
  const auto ticks = half + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(half));
  std::int64_t begin = -1;
  ASSERT_TRUE(hosts().plant_ear.until([&](const Heard& heard) {
    if (heard.channel != Channel::kState) return false;
    const std::int64_t tick = heard.as<state_t>().header.tick;
    if (begin < 0) begin = tick;
    return tick - begin >= ticks;
  })) << "its time stands still";
}

void Faults::keeps_balancing(std::int64_t ticks) {
  std::int64_t begin = -1;
  state_t state{};
  const bool came = hosts().plant_ear.until([&](const Heard& heard) {
    if (heard.channel != Channel::kState) return false;
    state = heard.as<state_t>();
    if (begin < 0) begin = state.header.tick;
    const double tilt = std::hypot(state.tilt_rad[0], state.tilt_rad[1]);
    return state.mode != status_t::MODE_RUNNING || tilt > kUpright ||
           state.header.tick - begin >= ticks;
  });
  ASSERT_TRUE(came) << "its time stands still at tick " << state.header.tick;
  ASSERT_GE(state.header.tick - begin, ticks)
      << mode_name(state.mode) << ", tilt " << state.tilt_rad[0] << " " << state.tilt_rad[1];
}

void Faults::stops_safely(const std::string& why) {
  const auto at_owner = hosts().plant_ear.owner_status(stopped);
  ASSERT_TRUE(at_owner) << "it has never stopped";
  const auto told = hosts().operator_ear.owner_status(stopped);
  ASSERT_TRUE(told) << "the operator was never told";
  told_ = get_text(told->text);
  EXPECT_NE(told_.find(why), std::string::npos) << told_;
}

status_t Faults::owner_status() {
  const auto status = hosts().plant_ear.owner_status([](const status_t&) { return true; });
  EXPECT_TRUE(status) << "no owner";
  return status.value_or(status_t{});
}

void Faults::asks(const Words& words, int code, const std::string& says) {
  ASSERT_EQ(hosts().ask("ctl", words), code) << hosts().said;
  told_ = hosts().said;
  ASSERT_NE(told_.find(says), std::string::npos) << told_;
}

}  // namespace gyrotwin::faults
