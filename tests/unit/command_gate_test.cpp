// Which commands an owner obeys: every rule of messages/README.md, "Commands", on its own.
#include "services/runtime/command_gate.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace gyrotwin {
namespace {

constexpr std::int64_t kEpoch = 77;

command_t command(std::int64_t for_tick, std::int64_t counter, double value = 1.0,
                  std::int64_t writer = 5) {
  command_t c{};
  c.mode = command_t::TORQUE_NM;
  c.valid_ticks = 10;
  c.value[0] = value;
  c.for_tick = for_tick;
  c.owner_epoch = kEpoch;
  c.writer = writer;
  c.counter = counter;
  return c;
}

CommandGate gate(int timeout = 10, int delay = 0) {
  CommandGate g(timeout, delay);
  g.reset(kEpoch);
  return g;
}

TEST(CommandGate, AnAcceptedCommandActsUntilReplaced) {
  CommandGate g = gate();
  EXPECT_EQ(g.acting(0), nullptr);
  ASSERT_TRUE(g.offer(command(0, 1, 2.5), 0));
  ASSERT_NE(g.acting(0), nullptr);
  EXPECT_EQ(g.acting(0)->value[0], 2.5);
  EXPECT_EQ(g.acting(3)->value[0], 2.5);
  ASSERT_TRUE(g.offer(command(3, 2, -1.0), 3));
  EXPECT_EQ(g.acting(3)->value[0], -1.0);
}

TEST(CommandGate, StopsActingWhenItsValidityEnds) {
  CommandGate g = gate();
  command_t c = command(4, 1);
  c.valid_ticks = 3;
  ASSERT_TRUE(g.offer(c, 4));
  EXPECT_NE(g.acting(6), nullptr);
  EXPECT_EQ(g.acting(7), nullptr);
}

TEST(CommandGate, RefusesWhatCannotBeMeant) {
  CommandGate g = gate();
  command_t c = command(0, 1);
  c.mode = 3;
  EXPECT_FALSE(g.offer(c, 0));
  c = command(0, 1);
  c.valid_ticks = 0;
  EXPECT_FALSE(g.offer(c, 0));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    c = command(0, 1);
    c.value[3] = bad;
    EXPECT_FALSE(g.offer(c, 0));
  }
  EXPECT_EQ(g.refusals().not_finite, 4);
  EXPECT_EQ(g.acting(0), nullptr);
}

TEST(CommandGate, RefusesAnotherRun) {
  CommandGate g = gate();
  command_t c = command(0, 1);
  c.owner_epoch = kEpoch + 1;
  EXPECT_FALSE(g.offer(c, 0));
  EXPECT_EQ(g.refusals().epoch, 1);
}

TEST(CommandGate, RefusesExpiredAndFutureTicks) {
  CommandGate g = gate();
  EXPECT_FALSE(g.offer(command(5, 1), 15));
  EXPECT_FALSE(g.offer(command(16, 1), 15));
  EXPECT_FALSE(g.offer(command(-1, 1), 0));
  EXPECT_FALSE(g.offer(command(std::numeric_limits<std::int64_t>::min(), 1), 15));
  EXPECT_FALSE(g.offer(command(std::numeric_limits<std::int64_t>::max(), 1), 15));
  EXPECT_EQ(g.refusals().expired, 5);
  EXPECT_TRUE(g.offer(command(6, 1), 15));
}

TEST(CommandGate, RefusesACounterThatDoesNotRise) {
  CommandGate g = gate();
  ASSERT_TRUE(g.offer(command(0, 8), 0));
  EXPECT_FALSE(g.offer(command(1, 8), 1));
  EXPECT_FALSE(g.offer(command(1, 7), 1));
  EXPECT_EQ(g.refusals().counter, 2);
  EXPECT_TRUE(g.offer(command(1, 9), 1));
  EXPECT_EQ(g.counter(), 9);
}

TEST(CommandGate, TheLeaseBelongsToTheFirstWriterUntilItExpires) {
  CommandGate g = gate(10);
  ASSERT_TRUE(g.offer(command(0, 1, 1.0, 5), 0));
  EXPECT_FALSE(g.offer(command(3, 100, 9.0, 6), 3));
  EXPECT_EQ(g.refusals().writer, 1);
  EXPECT_EQ(g.writer(), 5);
  ASSERT_TRUE(g.offer(command(3, 2, 1.0, 5), 3));
  EXPECT_FALSE(g.offer(command(12, 100, 9.0, 6), 12));
  EXPECT_TRUE(g.offer(command(13, 100, 9.0, 6), 13));
  EXPECT_EQ(g.writer(), 6);
}

TEST(CommandGate, AWriterThatHasLostTheLeaseCannotBePlayedBack) {
  CommandGate g = gate(10);
  command_t recorded = command(0, 7, 9.0, 5);
  recorded.valid_ticks = 1000;
  ASSERT_TRUE(g.offer(recorded, 0));
  ASSERT_TRUE(g.offer(command(10, 1, 1.0, 6), 10));
  EXPECT_FALSE(g.offer(recorded, 20));
  EXPECT_EQ(g.refusals().counter, 1);
  g.release();
  EXPECT_FALSE(g.offer(recorded, 20));
  EXPECT_EQ(g.writer(), 0);
  EXPECT_TRUE(g.offer(command(20, 8, 1.0, 5), 20));
}

TEST(CommandGate, EveryWriterTakesTheLeaseZeroToo) {
  CommandGate g = gate(10);
  ASSERT_TRUE(g.offer(command(0, 1, 1.0, 0), 0));
  EXPECT_FALSE(g.offer(command(1, 1, 1.0, 6), 1));
  EXPECT_EQ(g.refusals().writer, 1);
}

TEST(CommandGate, IsLostAfterExactlyItsTimeout) {
  CommandGate g = gate(7);
  ASSERT_TRUE(g.offer(command(20, 1), 20));
  EXPECT_FALSE(g.lost(26));
  EXPECT_TRUE(g.lost(27));
  CommandGate never = gate(7);
  EXPECT_FALSE(never.lost(6));
  EXPECT_TRUE(never.lost(7));
}

TEST(CommandGate, DelaysByTicks) {
  CommandGate g = gate(10, 2);
  for (std::int64_t k = 0; k < 6; ++k) {
    ASSERT_TRUE(g.offer(command(k, k + 1, static_cast<double>(k)), k));
    const command_t* acting = g.acting(k);
    if (k < 2) {
      EXPECT_EQ(acting, nullptr);
    } else {
      ASSERT_NE(acting, nullptr);
      EXPECT_EQ(acting->value[0], static_cast<double>(k - 2));
    }
  }
}

TEST(CommandGate, ARepeatedAnswerPushesOutNothing) {
  CommandGate g = gate(10, CommandGate::kMaxDelay);
  std::int64_t counter = 0;
  const auto offer = [&](std::int64_t tick) {
    command_t c = command(tick, ++counter, static_cast<double>(tick));
    c.valid_ticks = 100;
    return g.offer(c, tick);
  };
  for (std::int64_t k = 0; k < 20; ++k) {
    for (int repeat = 0; repeat < 5; ++repeat) ASSERT_TRUE(offer(k));
    const command_t* acting = g.acting(k);
    if (k < CommandGate::kMaxDelay) continue;
    ASSERT_NE(acting, nullptr);
    EXPECT_EQ(acting->value[0], static_cast<double>(k - CommandGate::kMaxDelay));
  }
}

TEST(CommandGate, AReleasedLeaseIsAnybodys) {
  CommandGate g = gate();
  ASSERT_TRUE(g.offer(command(0, 5, 1.0, 5), 0));
  EXPECT_FALSE(g.offer(command(0, 1, 1.0, 6), 0));
  g.release();
  EXPECT_TRUE(g.offer(command(0, 1, 1.0, 6), 0));
}

TEST(CommandGate, ResetForgetsLeaseAndValueButNotTheCounts) {
  CommandGate g = gate();
  ASSERT_TRUE(g.offer(command(0, 9), 0));
  EXPECT_FALSE(g.offer(command(0, 9), 0));
  g.reset(kEpoch + 1);
  EXPECT_EQ(g.acting(0), nullptr);
  EXPECT_EQ(g.writer(), 0);
  EXPECT_EQ(g.refusals().counter, 1);
  command_t c = command(0, 10);
  EXPECT_FALSE(g.offer(c, 0)) << "meant for the run before";
  c.owner_epoch = kEpoch + 1;
  EXPECT_TRUE(g.offer(c, 0));
}

TEST(CommandGate, AnswersTellLockstepWhenToStep) {
  CommandGate g = gate();
  EXPECT_FALSE(g.answered(0));
  ASSERT_TRUE(g.offer(command(0, 1), 0));
  EXPECT_TRUE(g.answered(0));
  EXPECT_FALSE(g.answered(1));
}

}  // namespace
}  // namespace gyrotwin
