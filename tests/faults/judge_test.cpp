// The judge itself: it must be able to find against the rig.
#include "tests/faults/judge.hpp"

#include <gtest/gtest.h>

#include "services/runtime/text.hpp"

namespace gyrotwin::faults {

namespace {

constexpr std::int64_t kTimeout = 10;
constexpr std::int64_t kEpoch = 5;

template <class Message>
support::Heard heard(Channel channel, const Message& message) {
  std::vector<std::uint8_t> payload(kWireSize<Message>);
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  return {channel, payload};
}

support::Heard state(std::int64_t tick, std::int32_t mode = status_t::MODE_RUNNING) {
  state_t state{};
  state.header.epoch = kEpoch;
  state.header.tick = tick;
  state.mode = mode;
  return heard(Channel::kState, state);
}

support::Heard command(std::int64_t for_tick, std::int64_t counter, std::int64_t writer = 1) {
  command_t command{};
  command.owner_epoch = kEpoch;
  command.for_tick = for_tick;
  command.valid_ticks = 10;
  command.writer = writer;
  command.counter = counter;
  return heard(Channel::kCommand, command);
}

support::Heard applied(const char* text) {
  reply_t reply{};
  reply.request_writer = 3;
  reply.request_counter = 4;
  reply.result = reply_t::APPLIED;
  set_text(reply.text, "{}", text);
  return heard(Channel::kReply, reply);
}

/// A judge that has heard ticks 0 to 4, each with its command.
Judge after_four_ticks() {
  Judge judge(kTimeout);
  for (std::int64_t tick = 0; tick <= 4; ++tick) {
    judge.hear(state(tick));
    judge.hear(command(tick, tick + 1));
  }
  return judge;
}

/// `count` more ticks after those four. @return how many complaints that makes
std::size_t complaints(Judge judge, std::int64_t count, std::int32_t then) {
  for (std::int64_t tick = 5; tick < 5 + count; ++tick) judge.hear(state(tick));
  judge.hear(state(5 + count, then));
  return judge.complaints().size();
}

}  // namespace

TEST(Judge, AcceptsASafeStopWithinTheTimeoutOnly) {
  // Tick 4 had a command. STATE 5 + n closes tick 4 + n, n ticks after it.
  EXPECT_EQ(complaints(after_four_ticks(), 10, status_t::MODE_SAFE_STOP), 0U);
  EXPECT_EQ(complaints(after_four_ticks(), 11, status_t::MODE_SAFE_STOP), 0U) << "see kComputing";
  EXPECT_GT(complaints(after_four_ticks(), 12, status_t::MODE_SAFE_STOP), 0U);
  EXPECT_GT(complaints(after_four_ticks(), 12, status_t::MODE_RUNNING), 0U);
}

TEST(Judge, CountsOnlyCommandsThatAreValid) {
  const std::pair<const char*, support::Heard> invalid[] = {
      {"a used counter", command(5, 5)},
      {"another writer", command(5, 99, 2)},
      {"for a tick to come", command(7, 99)},
  };
  for (const auto& [what, heard] : invalid) {
    Judge judge = after_four_ticks();
    judge.hear(state(5));
    judge.hear(heard);
    judge.hear(state(6, status_t::MODE_SAFE_STOP));
    EXPECT_EQ(judge.ticks().to_stop, 1) << what;
  }
  Judge judge = after_four_ticks();
  judge.hear(state(5));
  judge.hear(command(5, 6));
  judge.hear(state(6, status_t::MODE_SAFE_STOP));
  EXPECT_EQ(judge.ticks().to_stop, 0);
}

TEST(Judge, FindsARequestThatActsTwice) {
  Judge judge(kTimeout);
  judge.hear(applied("number 1"));
  judge.hear(applied("number 1"));
  EXPECT_TRUE(judge.complaints().empty());
  judge.hear(applied("number 2"));
  EXPECT_EQ(judge.complaints().size(), 1U);
}

}  // namespace gyrotwin::faults
