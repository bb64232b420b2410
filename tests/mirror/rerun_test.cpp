// A record once more: the bytes of the first time, and a difference where there is one.
#include "clients/rerun/rerun.hpp"

#include <gtest/gtest.h>

#include "clients/rerun/comparison.hpp"
#include "services/runtime/bus.hpp"
#include "tests/support/mirrored_loop.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

using support::MirroredLoop;

class Recorder {
 public:
  explicit Recorder(const Rig& rig) : prefix_(rig.network.prefix) {
    const About about{.program = "test",
                      .host = "here",
                      .rig = rig.name,
                      .prefix = prefix_,
                      .rig_id = rig.id,
                      .key = "",
                      .channels = channels_of(prefix_)};
    log_ = opening_events(about, lcm_sources(), "", kTime);
  }
  template <class Message>
  void keep(Channel channel, const Message& message) {
    LogBytes payload(kWireSize<Message>);
    message.encode(payload.data(), 0, static_cast<int>(payload.size()));
    append_event(log_, {number_, kTime + 100 * number_,
                        prefix_ + "/" + std::string(spec(channel).suffix), payload});
    ++number_;
  }
  const LogBytes& log() const { return log_; }

 private:
  static constexpr std::int64_t kTime = 1'700'000'000'000'000;
  std::string prefix_;
  LogBytes log_;
  std::int64_t number_ = 100;
};

/// Two seconds of a rig, as a recorder hears them.
/// @param spoil the torque of one command
/// @param swap every other STATE with the command that answers it
LogBytes recorded(MirroredLoop& loop, bool spoil = false, bool swap = false) {
  Recorder recorder(loop.rig);
  loop.hear();
  loop.ask(request_t::ARM);
  for (int k = 0; k < 1000; ++k) {
    loop.hear();
    status_t status{};
    loop.integrator.fill(status);
    status.header = loop.state.header;
    recorder.keep(Channel::kIntegratorStatus, status);
    const bool late = swap && k % 2 == 1;
    if (!late) recorder.keep(Channel::kState, loop.state);
    recorder.keep(Channel::kSensors, loop.sensors);
    if (loop.twin_told) recorder.keep(Channel::kTwinState, loop.twin);
    if (loop.forecast_told) recorder.keep(Channel::kForecast, loop.forecast);
    if (loop.commanded) {
      command_t command = loop.command;
      command.header = loop.state.header;
      if (spoil && k == 700) command.value[1] += 0.25;
      recorder.keep(Channel::kCommand, command);
    }
    if (late) recorder.keep(Channel::kState, loop.state);
    loop.integrator.advance();
  }
  return recorder.log();
}

struct Made {
  std::vector<std::string> messages;
  Take take() {
    return [this](Channel, std::span<const std::uint8_t> payload, std::int64_t) {
      messages.emplace_back(payload.begin(), payload.end());
    };
  }
};

TEST(Rerun, TheMirrorMakesTheSameOfTheSameLog) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  const LogBytes bytes = recorded(loop);
  Made first, second;
  Log log = support::open(bytes), again = support::open(bytes);
  const Account account = rerun_mirror(log, loop.rig, first.take());
  rerun_mirror(again, loop.rig, second.take());
  EXPECT_EQ(first.messages, second.messages);
  EXPECT_GT(account.compared, 400);
  EXPECT_GE(account.recorded, account.compared);
  EXPECT_EQ(account.different, 0) << account.first_difference;
}

TEST(Rerun, TheControllerGivesTheRecordedCommands) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  const LogBytes bytes = recorded(loop);
  Log log = support::open(bytes);
  const Account account = rerun_controller(log, loop.rig, RerunOn::kLive, {});
  EXPECT_GE(account.compared, 999);
  EXPECT_EQ(account.different, 0) << account.first_difference;
}

// Epochs are random: a run that comes later may have the smaller one.
TEST(Rerun, WhatWaitsLongestForItsCounterpartGoesFirst) {
  Comparison comparison;
  const Comparison::Payload payload;
  for (std::int64_t sequence = 0; sequence < 20'000; ++sequence) {
    comparison.made(Channel::kTwinState, 2, sequence, payload);
  }
  comparison.made(Channel::kTwinState, 1, 7, payload);
  comparison.recorded(Channel::kTwinState, 1, 7, payload);
  EXPECT_EQ(comparison.compared(), 1);
  comparison.recorded(Channel::kTwinState, 2, 0, payload);
  EXPECT_EQ(comparison.compared(), 1) << "it is gone";
  comparison.recorded(Channel::kTwinState, 2, 1, payload);
  EXPECT_EQ(comparison.compared(), 2);
}

TEST(Rerun, CounterpartsOfWhichNoneIsComparedAreInVain) {
  EXPECT_EQ(in_vain({.made = 3, .recorded = 3, .compared = 3}), "");
  EXPECT_EQ(in_vain({.made = 3}), "") << "a record without a twin";
  EXPECT_EQ(in_vain({.recorded = 3}), "nothing came of it");
  EXPECT_NE(in_vain({.made = 3, .recorded = 5}).find("none of the 5 recorded messages"),
            std::string::npos);
}

// The owner repeats what it holds, and a recorder hears more or fewer of the answers.
TEST(Rerun, RepeatsWhileHeldAreNotCompared) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  Recorder recorder(loop.rig);
  loop.hear();
  for (int k = 0; k < 5; ++k) {
    loop.sensors.gyro_rad_s[0] = 0.001 * k;  // other noise each time
    recorder.keep(Channel::kSensors, loop.sensors);
    state_t twin = loop.twin;
    twin.header = loop.sensors.header;
    if (k % 2 == 0) recorder.keep(Channel::kTwinState, twin);
  }
  Log log = support::open(recorder.log());
  const Account account = rerun_mirror(log, loop.rig, {});
  EXPECT_EQ(loop.sensors.header.sequence, 0);
  EXPECT_EQ(account.compared, 0);
  EXPECT_EQ(account.different, 0) << account.first_difference;
}

/// A record, of which only some events are kept.
/// @param kept (channel, tick)
template <class Kept>
LogBytes thinned(const LogBytes& whole, const Rig& rig, Kept&& kept) {
  Log source = support::open(whole);
  Recorder recorder(rig);
  while (const auto event = source.next()) {
    const auto keep = [&](Channel channel, auto message) {
      const std::string name = rig.network.prefix + "/" + std::string(spec(channel).suffix);
      if (event->channel != name) return;
      Bus::decode({channel, false, event->data}, message);
      if (kept(channel, message.header.tick)) recorder.keep(channel, message);
    };
    keep(Channel::kState, state_t{});
    keep(Channel::kSensors, sensors_t{});
    keep(Channel::kTwinState, state_t{});
    keep(Channel::kForecast, forecast_t{});
    keep(Channel::kIntegratorStatus, status_t{});
    keep(Channel::kCommand, command_t{});
  }
  return recorder.log();
}

bool from_mid_run(Channel /*channel*/, std::int64_t tick) { return tick > 500; }

TEST(Rerun, ALawThatRemembersIsNotComparedFromMidRun) {
  MirroredLoop loop("prototype_b", {"controller.law=constant_speed"});
  const LogBytes whole = recorded(loop);
  Log log = support::open(whole);
  const Account all = rerun_controller(log, loop.rig, RerunOn::kLive, {});
  EXPECT_EQ(all.unknown, 0);
  EXPECT_GT(all.compared, 400);
  EXPECT_EQ(all.different, 0) << all.first_difference;

  Log late = support::open(thinned(whole, loop.rig, from_mid_run));
  const Account account = rerun_controller(late, loop.rig, RerunOn::kLive, {});
  EXPECT_GT(account.unknown, 400);
  EXPECT_EQ(account.compared, 0);
  EXPECT_NE(in_vain(account).find("begins in mid-run"), std::string::npos) << in_vain(account);
}

TEST(Rerun, AnAnswerThatIsHeardBeforeItsQuestionIsNotMissing) {
  MirroredLoop loop("prototype_b", {"controller.law=constant_speed"});
  Log log = support::open(recorded(loop, false, true));
  const Account account = rerun_controller(log, loop.rig, RerunOn::kLive, {});
  EXPECT_GE(account.compared, 999);
  EXPECT_EQ(account.unknown, 0) << account.why_unknown;
  EXPECT_EQ(account.different, 0) << account.first_difference;
}

TEST(Rerun, AMirrorIsNotComparedFromMidRun) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  Log late = support::open(thinned(recorded(loop), loop.rig, from_mid_run));
  const Account account = rerun_mirror(late, loop.rig, {});
  EXPECT_GT(account.unknown, 400);
  EXPECT_EQ(account.compared, 0);
  EXPECT_NE(in_vain(account).find("begins in mid-run"), std::string::npos) << in_vain(account);
}

TEST(Rerun, AMirrorThatMayHaveMissedSomethingIsNotComparedFromThereOn) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  const auto but_one = [](Channel channel, std::int64_t tick) {
    return channel != Channel::kTwinState || tick != 600;
  };
  Log log = support::open(thinned(recorded(loop), loop.rig, but_one));
  const Account account = rerun_mirror(log, loop.rig, {});
  EXPECT_GT(account.compared, 500);
  EXPECT_GT(account.unknown, 300);
  EXPECT_EQ(account.different, 0) << account.first_difference;
  EXPECT_NE(account.why_unknown.find("sequence 601 "), std::string::npos) << account.why_unknown;
}

TEST(Rerun, TheFirstDifferenceIsNamed) {
  MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  const LogBytes bytes = recorded(loop, true);
  Log log = support::open(bytes);
  const Account account = rerun_controller(log, loop.rig, RerunOn::kLive, {});
  EXPECT_EQ(account.different, 1);
  EXPECT_NE(account.first_difference.find("LIVE/COMMAND, sequence 701"), std::string::npos)
      << account.first_difference;
  EXPECT_NE(account.first_difference.find("\"value\""), std::string::npos)
      << account.first_difference;
}

}  // namespace
}  // namespace gyrotwin
