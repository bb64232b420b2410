// The owner's rules on real physics, without bus or clock.
#include "services/integrator/integrator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "services/controller/controller.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/closed_loop.hpp"

namespace gyrotwin {
namespace {

using support::ClosedLoop;

TEST(Integrator, HoldsThePlantUntilArmed) {
  ClosedLoop loop("prototype_b");
  const model::State before = loop.integrator.plant().state();
  for (int i = 0; i < 100; ++i) loop.integrator.advance();
  EXPECT_EQ(loop.integrator.mode(), Mode::kHeld);
  EXPECT_EQ(loop.integrator.tick(), 0);
  EXPECT_EQ(loop.integrator.sequence(), 0);
  EXPECT_TRUE(loop.integrator.plant().state().q == before.q);
}

TEST(Integrator, RefusesToArmWithoutAControllerOrBesideAnotherOwner) {
  ClosedLoop loop("prototype_b");
  loop.surroundings.controller_heard = false;
  EXPECT_EQ(loop.ask(request_t::ARM).result, reply_t::REFUSED);
  loop.surroundings = {.controller_heard = true, .other_owner_heard = true, .fresh_epoch = 2};
  EXPECT_EQ(loop.ask(request_t::ARM).result, reply_t::REFUSED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kHeld);
  loop.surroundings.other_owner_heard = false;
  const reply_t reply = loop.ask(request_t::ARM);
  EXPECT_EQ(reply.result, reply_t::APPLIED);
  EXPECT_EQ(reply.applied_tick, 0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
}

// Each rig takes its reference push and comes back: peak between 2 and 8 degrees.
class Push : public testing::TestWithParam<const char*> {};

TEST_P(Push, IsVisibleAndRecoveredFrom) {
  ClosedLoop loop(GetParam());
  loop.arm();
  loop.run_seconds(3.0);
  const double before = loop.tilt_deg();
  request_t push{};
  push.kind = request_t::LOAD;
  push.duration_ns = static_cast<std::int64_t>(loop.rig.impulse_duration_s * 1e9);
  push.moment_nm[0] = loop.rig.reference_impulse_nms / loop.rig.impulse_duration_s;
  ASSERT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::APPLIED);
  const double peak = loop.run_seconds(2.0);
  EXPECT_GT(peak, 2.0);
  EXPECT_LT(peak, 8.0);
  loop.run_seconds(18.0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
  EXPECT_LT(loop.tilt_deg(), std::max(1.0, before));
}

INSTANTIATE_TEST_SUITE_P(Rigs, Push,
                         testing::Values("prototype_b", "prototype_b_sleeping", "double_brennan",
                                         "brennan_monorail"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Integrator, StopsSafelyAfterExactlyTheTimeout) {
  ClosedLoop loop("double_brennan");
  loop.arm();
  loop.run_ticks(500);
  loop.controller_alive = false;
  const std::int64_t last_answered = loop.integrator.tick() - 1;
  while (loop.integrator.mode() == Mode::kRunning) loop.run_ticks(1);
  EXPECT_EQ(loop.integrator.mode(), Mode::kSafeStop);
  // The tick in which the mode changes already has the safe drive.
  EXPECT_EQ(loop.integrator.tick() - 1 - last_answered, loop.rig.safety.command_timeout_ticks);
  loop.run_seconds(10.0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kFallen) << "with its gimbals braked nothing holds it up";

  // Back: reset, arm, balance.
  loop.controller_alive = true;
  EXPECT_EQ(loop.ask(request_t::ARM).result, reply_t::REFUSED);
  loop.surroundings.fresh_epoch = 1234;
  EXPECT_EQ(loop.ask(request_t::RESET).result, reply_t::APPLIED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kHeld);
  EXPECT_EQ(loop.integrator.epoch(), 1234);
  loop.arm();
  loop.run_seconds(5.0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
  EXPECT_LT(loop.tilt_deg(), 1.0);
}

TEST(Integrator, AFallenPlatformLiesStillAndStaysFinite) {
  ClosedLoop loop("double_brennan", {"initial.q=[0.3, 0.2, 0.0, 0.0]"});
  loop.arm();
  loop.controller_alive = false;
  loop.run_seconds(20.0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kFallen);
  EXPECT_TRUE(loop.integrator.plant().state().finite());
  EXPECT_GT(loop.tilt_deg(), 80.0);
  EXPECT_TRUE(loop.integrator.plant().state().v.isZero(0));
}

TEST(Integrator, PausesStepsAndResumes) {
  ClosedLoop loop("prototype_b");
  EXPECT_EQ(loop.ask(request_t::PAUSE).result, reply_t::REFUSED);
  loop.arm();
  loop.run_ticks(10);
  EXPECT_EQ(loop.ask(request_t::PAUSE).result, reply_t::APPLIED);
  loop.run_ticks(10);
  EXPECT_EQ(loop.integrator.tick(), 10);

  request_t step{};
  step.step_ticks = 3;
  EXPECT_EQ(loop.ask(request_t::STEP, step).result, reply_t::APPLIED);
  loop.run_ticks(20);
  EXPECT_EQ(loop.integrator.tick(), 13);
  EXPECT_EQ(loop.integrator.mode(), Mode::kPaused);
  for (const std::int64_t bad : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1} << 60}) {
    step.step_ticks = bad;
    EXPECT_EQ(loop.ask(request_t::STEP, step).result, reply_t::REFUSED);
  }
  EXPECT_EQ(loop.ask(request_t::RESUME).result, reply_t::APPLIED);
  loop.run_ticks(5);
  EXPECT_EQ(loop.integrator.tick(), 18);
}

TEST(Integrator, AnAnswerIsGivenAgainAndNotDoneAgain) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  request_t push{};
  push.kind = request_t::LOAD;
  push.duration_ns = 20'000'000;
  push.moment_nm[0] = 10.0;
  const reply_t first = loop.ask(request_t::DISTURB, push);
  loop.run_ticks(5);
  reply_t again;
  loop.integrator.on_request(loop.last_request, loop.surroundings, again);
  EXPECT_EQ(again.applied_tick, first.applied_tick);
  EXPECT_STREQ(reinterpret_cast<const char*>(again.text),
               reinterpret_cast<const char*>(first.text));
  loop.run_ticks(1);
  truth_t truth;
  loop.integrator.fill(truth);
  EXPECT_EQ(truth.external_moment_nm[0], 10.0) << "applied twice";
}

TEST(Integrator, AnAnswerIsKeptForEachAsker) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  const request_t arm = loop.last_request;
  request_t other = arm;
  other.writer = 77;
  other.verb = request_t::PAUSE;
  reply_t reply;
  loop.integrator.on_request(other, loop.surroundings, reply);
  EXPECT_EQ(reply.result, reply_t::APPLIED);
  loop.integrator.on_request(arm, loop.surroundings, reply);
  EXPECT_EQ(reply.result, reply_t::APPLIED) << "the first one's answer again";
  EXPECT_EQ(reply.verb, request_t::ARM);
  EXPECT_EQ(loop.integrator.mode(), Mode::kPaused);
}

TEST(Integrator, ARecordedRequestDoesNothingWhenSentLater) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  const request_t arm = loop.last_request;
  loop.ask(request_t::DISARM);
  reply_t reply;
  loop.integrator.on_request(arm, loop.surroundings, reply);
  EXPECT_EQ(reply.result, reply_t::REFUSED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kSafeStop);
}

// Whoever records a request can wait until its asker's answer is forgotten.
TEST(Integrator, ARecordedRequestDoesNothingHoweverManyHaveAskedSince) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  request_t recorded = loop.last_request;
  recorded.writer = 55;
  recorded.verb = request_t::PAUSE;
  reply_t reply;
  loop.integrator.on_request(recorded, loop.surroundings, reply);
  ASSERT_EQ(reply.result, reply_t::APPLIED);
  ASSERT_EQ(loop.ask(request_t::RESUME).result, reply_t::APPLIED);
  request_t other = recorded;
  other.verb = request_t::CLEAR;
  for (other.writer = 100; other.writer < 200; ++other.writer) {
    loop.integrator.on_request(other, loop.surroundings, reply);
    ASSERT_EQ(reply.result, reply_t::APPLIED);
  }

  loop.integrator.on_request(recorded, loop.surroundings, reply);
  EXPECT_EQ(reply.result, reply_t::REFUSED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
  ++recorded.counter;  // the asker itself goes on
  loop.integrator.on_request(recorded, loop.surroundings, reply);
  EXPECT_EQ(reply.result, reply_t::APPLIED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kPaused);
}

TEST(Integrator, DisturbsInTheTicksItSays) {
  ClosedLoop loop("prototype_b");
  request_t push{};
  push.kind = request_t::LOAD;
  push.duration_ns = 3'400'000;  // rounds to 3 ticks of 1 ms
  push.moment_nm[1] = 4.0;
  EXPECT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::REFUSED) << "held";
  push.start_tick = 7;
  const reply_t reply = loop.ask(request_t::DISTURB, push);
  ASSERT_EQ(reply.result, reply_t::APPLIED);
  EXPECT_EQ(reply.applied_tick, 7);
  loop.arm();
  for (int tick = 0; tick < 15; ++tick) {
    loop.run_ticks(1);
    truth_t truth;
    loop.integrator.fill(truth);
    EXPECT_EQ(truth.external_moment_nm[1], tick >= 7 && tick < 10 ? 4.0 : 0.0) << tick;
  }
  push.start_tick = 3;
  EXPECT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::REFUSED) << "over";
}

TEST(Integrator, ALoadLastsUntilCleared) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  request_t load{};
  load.kind = request_t::LOAD;
  load.force_n[0] = 1.5;
  ASSERT_EQ(loop.ask(request_t::DISTURB, load).result, reply_t::APPLIED);
  loop.run_ticks(3000);
  truth_t truth;
  loop.integrator.fill(truth);
  EXPECT_EQ(truth.external_force_n[0], 1.5);
  ASSERT_EQ(loop.ask(request_t::CLEAR).result, reply_t::APPLIED);
  loop.run_ticks(1);
  loop.integrator.fill(truth);
  EXPECT_EQ(truth.external_force_n[0], 0.0);
}

TEST(Integrator, RefusesDisturbancesWhereThereIsNothingToDisturb) {
  ClosedLoop loop("prototype_b");
  request_t push{};
  push.kind = request_t::LOAD;
  push.moment_nm[0] = 1.0;
  EXPECT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::REFUSED) << "held";
  request_t cut{};
  cut.kind = request_t::COMMAND_LOST;
  EXPECT_EQ(loop.ask(request_t::FAULT, cut).result, reply_t::REFUSED) << "held";
  loop.arm();
  push.duration_ns = -1;
  EXPECT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::REFUSED) << "by the schedule";
  loop.integrator.notice(Event::kTiltLimit, "");
  push.duration_ns = 0;
  EXPECT_EQ(loop.ask(request_t::DISTURB, push).result, reply_t::REFUSED) << "fallen";
  EXPECT_EQ(loop.ask(request_t::FAULT, cut).result, reply_t::REFUSED) << "fallen";
}

TEST(Integrator, ResetTakesAnInitialStateAndRefusesBadOnes) {
  ClosedLoop loop("prototype_b");
  request_t reset{};
  reset.initial_given = 1;
  reset.initial_q[0] = 0.02;
  reset.initial_v[2] = -4.0;
  ASSERT_EQ(loop.ask(request_t::RESET, reset).result, reply_t::APPLIED);
  EXPECT_EQ(loop.integrator.plant().state().q[0], 0.02);
  EXPECT_EQ(loop.integrator.plant().state().v[2], -4.0);
  reset.initial_q[0] = std::nan("");
  EXPECT_EQ(loop.ask(request_t::RESET, reset).result, reply_t::REFUSED);
  reset.initial_q[0] = 1.2;
  EXPECT_EQ(loop.ask(request_t::RESET, reset).result, reply_t::REFUSED);
  EXPECT_EQ(loop.integrator.plant().state().q[0], 0.02);
}

TEST(Integrator, AStateThatIsNotFiniteIsAFaultWithItsHistory) {
  ClosedLoop loop("prototype_b");
  request_t reset{};
  reset.initial_given = 1;
  reset.initial_v[0] = 1e200;
  ASSERT_EQ(loop.ask(request_t::RESET, reset).result, reply_t::APPLIED);
  loop.arm();
  loop.run_ticks(5);
  EXPECT_EQ(loop.integrator.mode(), Mode::kFault);
  std::vector<std::int64_t> history;
  loop.integrator.visit_history([&](const TickRecord& record) { history.push_back(record.tick); });
  EXPECT_EQ(history, (std::vector<std::int64_t>{0})) << "the tick that failed, last";
  EXPECT_EQ(loop.integrator.plant().state().v[0], 1e200) << "the last state that can be trusted";
  const std::int64_t tick = loop.integrator.tick();
  loop.run_ticks(5);
  EXPECT_EQ(loop.integrator.tick(), tick);
  EXPECT_EQ(loop.ask(request_t::RESET).result, reply_t::APPLIED);
  EXPECT_EQ(loop.integrator.mode(), Mode::kHeld);
}

TEST(Integrator, SpeedIsForPacedClocks) {
  ClosedLoop loop("prototype_b");
  request_t speed{};
  speed.speed_factor = 0.5;
  EXPECT_EQ(loop.ask(request_t::SPEED, speed).result, reply_t::APPLIED);
  EXPECT_EQ(loop.integrator.speed(), 0.5);
  for (const double bad : {0.0, -1.0, 1e6, std::nan("")}) {
    speed.speed_factor = bad;
    EXPECT_EQ(loop.ask(request_t::SPEED, speed).result, reply_t::REFUSED);
  }
  ClosedLoop lockstep("prototype_b", {"loop.clock=lockstep"});
  speed.speed_factor = 0.5;
  EXPECT_EQ(lockstep.ask(request_t::SPEED, speed).result, reply_t::REFUSED);
}

TEST(Integrator, RunsAreRepeatableToTheLastBit) {
  const auto run = [] {
    ClosedLoop loop("prototype_b");
    loop.arm();
    loop.run_seconds(2.0);
    state_t state;
    loop.integrator.fill(state);
    return state;
  };
  const state_t a = run(), b = run();
  EXPECT_EQ(std::memcmp(a.tilt_rad, b.tilt_rad, sizeof(a.tilt_rad)), 0);
  EXPECT_EQ(std::memcmp(a.gimbal_rate_rad_s, b.gimbal_rate_rad_s, sizeof(a.gimbal_rate_rad_s)), 0);
  EXPECT_NE(a.tilt_rad[0], 0.0);
}

TEST(Integrator, SafeStopDrivesAsTheRigFileSays) {
  const auto disc_rate_after_stop = [](const std::string& drive) {
    ClosedLoop loop("prototype_b",
                    {"safety.safe_stop=" + drive, "safety.safe_stop_gain_nms_per_rad=5"});
    loop.arm();
    loop.run_seconds(1.0);
    loop.ask(request_t::DISARM);
    loop.run_seconds(0.4);
    EXPECT_EQ(loop.integrator.mode(), Mode::kSafeStop);
    return loop.integrator.plant().machine().observe(loop.integrator.plant().state()).disc_rate;
  };
  const double coasting = disc_rate_after_stop("zero_torque");
  EXPECT_LT(std::abs(disc_rate_after_stop("brake")), 0.5 * std::abs(coasting));
  EXPECT_GT(std::abs(disc_rate_after_stop("hold_speed")), std::abs(coasting));
}

}  // namespace
}  // namespace gyrotwin
