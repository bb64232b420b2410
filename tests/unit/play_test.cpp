// Playing a scenario to an owner that takes it, or does not.
#include "clients/disturb/play.hpp"

#include <gtest/gtest.h>

#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/fake_owner.hpp"

namespace gyrotwin {
namespace {

std::vector<PlannedEvent> three() {
  return read_scenario(R"(
[[event]]
kind = "step"
at_s = 1
roll_nm = 1
[[event]]
kind = "link"
at_s = 2
duration_s = 0.005
[[event]]
kind = "rotor"
at_s = 3
rotor = 0
)",
                       "s.toml");
}

/// Numbers what it takes from 11 on, and refuses faults of rotors if so told.
FakeOwner::Answer owner(bool refuses_rotors) {
  return [refuses_rotors, next = std::int64_t{11}](const request_t& request,
                                                   std::int64_t&) mutable {
    reply_t reply{};
    const bool rotor = request.verb == request_t::FAULT && request.kind == request_t::ROTOR_LOSS;
    reply.result = rotor && refuses_rotors ? +reply_t::REFUSED : +reply_t::APPLIED;
    reply.id = next++;
    set_text(reply.text, "rotors keep their speed");
    return std::optional(reply);
  };
}

TEST(Play, AsksForEveryEventInOrderOfTime) {
  const Rig rig = fake_rig();
  FakeOwner fake(bus_config(rig, header_t::SIMULATION), owner(false));
  MonotonicClock clock;
  Asker asker(rig, clock);
  play(asker, rig, three());
  const auto& requests = fake.stop();
  ASSERT_EQ(requests.size(), 3u);
  EXPECT_EQ(requests[0].kind, request_t::LOAD);
  EXPECT_EQ(requests[0].start_tick, 1000) << "HELD: counted from tick 0";
  EXPECT_EQ(requests[1].kind, request_t::COMMAND_LOST);
  EXPECT_EQ(requests[1].duration_ns, 5'000'000);
  EXPECT_EQ(requests[2].start_tick, 3000);
}

TEST(Play, IsAllOrNothing) {
  const Rig rig = fake_rig();
  FakeOwner fake(bus_config(rig, header_t::SIMULATION), owner(true));
  MonotonicClock clock;
  Asker asker(rig, clock);
  try {
    play(asker, rig, three());
    FAIL();
  } catch (const NotDone& error) {
    EXPECT_STREQ(error.what(),
                 "s.toml:10: rotor refused: rotors keep their speed; the events before it are "
                 "cancelled");
  }
  const auto& requests = fake.stop();
  ASSERT_EQ(requests.size(), 5u);
  EXPECT_EQ(requests[3].verb, request_t::CANCEL);
  EXPECT_EQ(requests[3].id, 11);
  EXPECT_EQ(requests[4].verb, request_t::CANCEL);
  EXPECT_EQ(requests[4].id, 12);
}

TEST(FirstTick, LeavesTimeForTheAsking) {
  status_t owner{};
  owner.header.tick = 5000;
  owner.tick_period_ns = 2'000'000;
  owner.speed_factor = 0.5;
  owner.mode = status_t::MODE_HELD;
  EXPECT_EQ(first_tick(owner), 0);
  owner.mode = status_t::MODE_PAUSED;
  EXPECT_EQ(first_tick(owner), 5001);
  owner.mode = status_t::MODE_RUNNING;
  EXPECT_EQ(first_tick(owner), 5050) << "0.2 s of wall time are 0.1 s";
}

}  // namespace
}  // namespace gyrotwin
