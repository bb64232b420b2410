// The mode machine: its table, and that no order of requests, commands and ticks breaks its
// promises.
#include "services/runtime/mode.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/closed_loop.hpp"

namespace gyrotwin {
namespace {

TEST(Modes, OneWayPerModeAndEvent) {
  for (const Transition& a : kTransitions) {
    EXPECT_EQ(
        std::count_if(kTransitions.begin(), kTransitions.end(),
                      [&](const Transition& b) { return a.from == b.from && a.event == b.event; }),
        1);
  }
}

TEST(Modes, OnlyResetLeadsBackToHeldAndEveryModeHasIt) {
  for (const Transition& t : kTransitions) {
    if (t.to == Mode::kHeld) {
      EXPECT_EQ(t.event, Event::kReset);
    }
  }
  for (int mode = 0; mode <= status_t::MODE_FAULT; ++mode) {
    EXPECT_EQ(next(static_cast<Mode>(mode), Event::kReset), Mode::kHeld);
  }
}

TEST(Modes, OnlyArmingAndTheEndOfAPauseLeadToRunning) {
  for (const Transition& t : kTransitions) {
    if (t.to == Mode::kRunning) {
      EXPECT_TRUE(t.from == Mode::kHeld || t.from == Mode::kPaused);
    }
  }
}

TEST(Modes, NamesOfWhatCameFromTheWireAreSafe) {
  EXPECT_EQ(mode_name(status_t::MODE_SAFE_STOP), "SAFE_STOP");
  EXPECT_EQ(mode_name(status_t::MODE_WAITING), "WAITING");
  for (const int unknown : {-1, 6, 15, 18, 1 << 30}) EXPECT_EQ(mode_name(unknown), "unknown");
}

// Random requests, controller deaths and pushes. Whatever happens:
TEST(Modes, PromisesHoldInRandomScenarios) {
  std::mt19937_64 random(20261);
  support::ClosedLoop loop("double_brennan");
  const Integrator& owner = loop.integrator;
  const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  int silent = 0;  // ticks of RUNNING since the last command
  std::array<int, 6> visits{};

  for (int i = 0; i < 100'000; ++i) {
    const Mode before = owner.mode();
    const std::int64_t tick = owner.tick(), epoch = owner.epoch();
    const int action = pick(100);
    bool reset = false;
    if (action < 2) {
      request_t request{};
      request.step_ticks = pick(4);
      request.speed_factor = 0.5 * pick(4);
      request.kind = pick(10);
      request.target = pick(3);
      request.id = pick(20);
      request.duration_ns = 1'000'000LL * pick(50);
      loop.surroundings.fresh_epoch = epoch + 1;
      loop.surroundings.controller_heard = pick(10) != 0;
      const std::int32_t verb = pick(request_t::FAULT + 2);
      if (verb == request_t::DISTURB) {
        request.kind = request_t::LOAD;
        request.target = 0;
        request.moment_nm[0] = 60.0 * (pick(3) - 1);
      }
      reset = loop.ask(verb, request).result == reply_t::APPLIED && verb == request_t::RESET;
    } else {
      loop.controller_alive = pick(500) == 0 ? !loop.controller_alive : loop.controller_alive;
      loop.run_ticks(1);
    }
    const Mode after = owner.mode();
    ++visits[static_cast<std::size_t>(after)];

    ASSERT_TRUE(owner.plant().state().finite());
    ASSERT_EQ(reset, owner.epoch() != epoch) << "a new run begins with a reset and nothing else";
    if (reset) {
      ASSERT_EQ(after, Mode::kHeld);
    } else {
      ASSERT_GE(owner.tick(), tick);
      ASSERT_LE(owner.tick(), tick + 1);
      ASSERT_TRUE(owner.tick() == tick || ticks(before))
          << "time stands still in " << name_of(before);
      ASSERT_FALSE(after == Mode::kRunning && before != Mode::kRunning && before != Mode::kHeld &&
                   before != Mode::kPaused);
    }
    ASSERT_TRUE(after != Mode::kHeld || owner.tick() == 0);

    if (owner.tick() == tick || loop.controller_alive) silent = 0;
    if (owner.tick() > tick && !loop.controller_alive) ++silent;
    ASSERT_TRUE(after != Mode::kRunning || silent <= loop.rig.safety.command_timeout_ticks);
  }
  for (std::size_t mode = 0; mode < visits.size() - 1; ++mode) {
    EXPECT_GT(visits[mode], 100) << "the scenario never saw " << name_of(static_cast<Mode>(mode));
  }
}

}  // namespace
}  // namespace gyrotwin
