#include "clients/top/monitor.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/heard.hpp"

namespace gyrotwin {
namespace {

constexpr Channel kOwner = Channel::kIntegratorStatus, kController = Channel::kControllerStatus;
constexpr std::int64_t kSecond = 1'000'000'000;

std::string last(const Listening& listening) {
  const Picture picture = listening.picture();
  if (picture.happenings.empty()) return "nothing";
  const Happening& happening = picture.happenings.back();
  return happening.who + ": " + happening.what;
}

std::size_t happened(const Listening& listening) { return listening.picture().happenings.size(); }

state_t state_at(std::int64_t tick, std::int64_t epoch = owner_status().header.epoch) {
  state_t state{};
  state.header.epoch = epoch;
  state.header.tick = tick;
  state.header.sim_time_ns = 1'000'000 * tick;
  return state;
}

/// Asks as writer 1, and the owner answers.
void ask(Listening& listening, request_t request, reply_t reply, std::int64_t counter) {
  request.writer = reply.request_writer = 1;
  request.counter = reply.request_counter = counter;
  reply.verb = request.verb;
  reply.header.epoch = owner_status().header.epoch;
  listening.hear(Channel::kRequest, request);
  listening.hear(Channel::kReply, reply);
}

request_t push(std::int64_t duration_ns) {
  request_t request{};
  request.verb = request_t::DISTURB;
  request.kind = request_t::LOAD;
  request.moment_nm[0] = 5.0;
  request.duration_ns = duration_ns;
  return request;
}

reply_t applied(std::int64_t tick, std::int64_t id = 0) {
  reply_t reply{};
  reply.result = reply_t::APPLIED;
  reply.applied_tick = tick;
  reply.id = id;
  set_text(reply.text, "as asked");
  return reply;
}

TEST(Monitor, KnowsNothingAtFirst) {
  Listening l;
  l.pass(kSecond);
  const Picture picture = l.picture();
  EXPECT_FALSE(picture.owner || picture.controller || picture.state || picture.latest);
  EXPECT_TRUE(picture.happenings.empty());
}

TEST(Monitor, SaysWhoComesAndWhoGoes) {
  Listening l;
  l.hear(kOwner, owner_status(status_t::MODE_HELD, "no controller is heard"));
  EXPECT_EQ(last(l), "owner: heard: 4711 on lab, HELD: no controller is heard");
  l.pass(kSecond - kTenth);
  EXPECT_TRUE(l.picture().owner_live());
  l.pass(kTenth);
  EXPECT_FALSE(l.picture().owner_live());
  EXPECT_EQ(last(l), "owner: not heard for 1 s; it was 4711 on lab, HELD");
  l.pass(kSecond);
  EXPECT_EQ(happened(l), 2U) << "silence is no news again";
  l.hear(kOwner, owner_status());
  EXPECT_EQ(last(l), "owner: heard again after 2 s, RUNNING");
  l.pass(kSecond);
  status_t next = owner_status();
  next.pid = 5000;
  l.hear(kOwner, next);
  EXPECT_EQ(last(l), "owner: is 5000 on lab now, before it was 4711 on lab; RUNNING");
  EXPECT_EQ(l.picture().owner->message.pid, 5000);
}

TEST(Monitor, TellsModesWithReasonsAndRuns) {
  Listening l;
  l.hear(kOwner, owner_status());
  l.hear(kOwner, owner_status(status_t::MODE_SAFE_STOP, "no valid command"));
  EXPECT_EQ(last(l), "owner: RUNNING -> SAFE_STOP: no valid command");
  status_t next = owner_status(status_t::MODE_SAFE_STOP);
  ++next.header.epoch;
  l.hear(kOwner, next);
  EXPECT_EQ(last(l), "owner: a new run begins, ticks count from 0");
  const std::size_t before = happened(l);
  l.hear(kController, controller_status());
  status_t follows = controller_status();
  ++follows.header.epoch;
  l.hear(kController, follows);
  EXPECT_EQ(happened(l), before + 1) << "a controller's epoch follows its owner's";
}

TEST(Monitor, TellsWhatTheTwinChangesItsMindAbout) {
  Listening l;
  l.hear(kOwner, owner_status());
  health_t health{};
  health.header = owner_status().header;
  l.hear(Channel::kHealth, health);
  EXPECT_EQ(happened(l), 1U) << "it settles, as every twin does at first";
  health.verdict = health_t::AGREES;
  set_text(health.text, "agrees");
  l.hear(Channel::kHealth, health);
  EXPECT_EQ(last(l), "twin: agrees");
  l.hear(Channel::kHealth, health);
  EXPECT_EQ(happened(l), 2U) << "once";
  health.verdict = health_t::DISAGREES;
  health.blame = health_t::DRIVE;
  set_text(health.text, "disagrees: drive 0");
  l.hear(Channel::kHealth, health);
  EXPECT_EQ(last(l), "twin: disagrees: drive 0");
  EXPECT_EQ(l.picture().happenings.back().level, Level::kBad);
  health.blame = health_t::INERTIA;
  set_text(health.text, "disagrees: inertia");
  l.hear(Channel::kHealth, health);
  EXPECT_EQ(last(l), "twin: disagrees: inertia") << "another reason";

  forecast_t forecast{};
  forecast.header = owner_status().header;
  forecast.outcome = forecast_t::STANDS;
  l.hear(Channel::kForecast, forecast);
  EXPECT_EQ(happened(l), 4U) << "what stands is no news";
  forecast.outcome = forecast_t::FALLS;
  forecast.falls_in_ns = 420'000'000;
  l.hear(Channel::kForecast, forecast);
  EXPECT_EQ(last(l), "forecast: it falls in 420 ms");
  forecast.outcome = forecast_t::STANDS;
  l.hear(Channel::kForecast, forecast);
  EXPECT_EQ(last(l), "forecast: it stands");
}

TEST(Monitor, TellsWhetherADeviceIsHeard) {
  Listening l;
  link_t link{};
  set_text(link.text, "/dev/ttyUSB0");
  link.connected = 1;
  l.hear(Channel::kLink, link);
  EXPECT_EQ(last(l), "line: the device is heard on /dev/ttyUSB0");
  link.connected = 0;
  set_text(link.text, "/dev/ttyUSB0: Input/output error");
  l.hear(Channel::kLink, link);
  l.hear(Channel::kLink, link);
  EXPECT_EQ(last(l), "line: the device is not heard on /dev/ttyUSB0: Input/output error");
  EXPECT_EQ(happened(l), 2U);
}

TEST(Monitor, TakesOnlyTheStateOfTheRunThatItFollows) {
  Listening l;
  l.hear(Channel::kState, state_at(7, 99));
  EXPECT_EQ(l.picture().state->message.header.tick, 7) << "nobody has said which run it is";
  l.hear(kOwner, owner_status());
  l.hear(Channel::kState, state_at(8, 99));
  EXPECT_EQ(l.picture().state->message.header.tick, 7) << "somebody else's";
  l.hear(Channel::kState, state_at(5001));
  EXPECT_EQ(l.picture().latest->tick, 5001) << "newer than STATUS";
  l.hear(kOwner, owner_status());
  EXPECT_EQ(l.picture().latest->tick, 5001) << "STATUS is older";
}

TEST(Monitor, ASecondOwnerIsNamedOnceAndNotFollowed) {
  Listening l;
  status_t other = owner_status(status_t::MODE_HELD);
  other.pid = 5000;
  for (int i = 0; i < 5; ++i) {
    l.hear(kOwner, owner_status());
    l.hear(kOwner, other);
    l.pass(kTenth);
  }
  EXPECT_EQ(last(l), "owner: another one speaks too: 5000 on lab");
  EXPECT_EQ(happened(l), 2U);
  EXPECT_EQ(l.picture().owner->message.pid, 4711);
}

TEST(Monitor, WhatWasNotHeardLatelyIsNotLive) {
  Listening l;
  l.hear(Channel::kState, state_at(1));
  l.hear(Channel::kTruth, truth_t{});
  l.pass(kSecond - kTenth);
  EXPECT_TRUE(l.picture().state->live());
  EXPECT_TRUE(l.picture().truth->live());
  l.pass(kTenth);
  EXPECT_FALSE(l.picture().state->live());
  EXPECT_FALSE(l.picture().truth->live());
}

TEST(Monitor, MeasuresRatesAndSpeedOverTheLastSecond) {
  Listening l;
  l.hear(kOwner, owner_status());
  for (std::int64_t tick = 5000; tick < 5100; tick += 5) {
    l.hear(kOwner, owner_status());
    for (int i = 0; i < 5; ++i) l.hear(Channel::kState, state_at(tick + i));
    l.pass(kTenth);
  }
  const ChannelTraffic states = l.picture().channels[static_cast<std::size_t>(Channel::kState)];
  EXPECT_DOUBLE_EQ(states.per_second, 50.0);
  EXPECT_EQ(states.received, 100);
  EXPECT_EQ(*states.age_ns, kTenth);
  EXPECT_DOUBLE_EQ(*l.picture().speed, 0.05);

  // A suspended program finds everything at once.
  l.clock.advance(10 * kSecond);
  for (int i = 0; i < 500; ++i) l.hear(Channel::kState, state_at(5100 + i));
  l.hear(kOwner, owner_status());
  l.pass(2 * kTenth);
  EXPECT_DOUBLE_EQ(l.picture().channels[0].per_second, 0.0);
}

TEST(Monitor, PassesOnWhatThisListenerLost) {
  Listening l;
  l.bus.gaps[0] = 3;
  l.bus.reordered[1] = 2;
  l.bus.unauthentic = 4;
  l.pass(kTenth);
  EXPECT_EQ(l.picture().channels[0].gaps, 3);
  EXPECT_EQ(l.picture().channels[1].reordered, 2);
  EXPECT_EQ(l.picture().bus.unauthentic, 4);
}

TEST(Monitor, TellsEveryAnswerOnce) {
  Listening l;
  request_t arm{};
  arm.verb = request_t::ARM;
  ask(l, arm, applied(0), 1);
  EXPECT_EQ(last(l), "reply: arm applied at tick 0: as asked");
  ask(l, arm, applied(0), 1);
  EXPECT_EQ(happened(l), 1U) << "the answer was sent again";
  reply_t refused{};
  refused.result = reply_t::REFUSED;
  set_text(refused.text, "HELD: arm first");
  ask(l, push(kSecond), refused, 2);
  EXPECT_EQ(last(l), "reply: disturb load: moment (5, 0, 0) N m refused: HELD: arm first");
  EXPECT_TRUE(l.picture().acting.empty());
}

TEST(Monitor, KeepsTheListOfWhatActs) {
  Listening l;
  l.hear(kOwner, owner_status());
  ask(l, push(20'000'000), applied(6000, 1), 1);
  request_t fault{};
  fault.verb = request_t::FAULT;
  fault.kind = request_t::DRIVE_WEAK;
  fault.level = 0.25;
  ask(l, fault, applied(5000, 2), 2);
  ASSERT_EQ(l.picture().acting.size(), 2U);
  EXPECT_EQ(l.picture().acting[0].begin, 6000);
  EXPECT_EQ(l.picture().acting[0].end, 6020);
  EXPECT_EQ(l.picture().acting[1].what, "drive 0: 25 % left");
  EXPECT_FALSE(l.picture().acting[1].end);

  l.hear(Channel::kState, state_at(6019));
  l.pass(kTenth);
  EXPECT_EQ(l.picture().acting.size(), 2U);
  l.hear(Channel::kState, state_at(6020));
  l.pass(kTenth);
  ASSERT_EQ(l.picture().acting.size(), 1U) << "over";
  EXPECT_TRUE(l.picture().acting[0].fault);

  request_t cancel{};
  cancel.verb = request_t::CANCEL;
  cancel.id = 2;
  ask(l, cancel, applied(6020), 3);
  EXPECT_TRUE(l.picture().acting.empty());

  request_t clear{};
  clear.verb = request_t::CLEAR;
  ask(l, push(0), applied(6020, 3), 4);
  ask(l, clear, applied(6021), 5);
  EXPECT_TRUE(l.picture().acting.empty());

  ask(l, push(0), applied(6021, 4), 6);
  status_t next = owner_status();
  ++next.header.epoch;
  l.hear(kOwner, next);
  l.pass(kTenth);
  EXPECT_TRUE(l.picture().acting.empty()) << "of another run";
}

}  // namespace
}  // namespace gyrotwin
