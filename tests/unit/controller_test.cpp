// From STATE to COMMAND: whom it follows, when it answers, what it repeats.
#include "services/controller/controller.hpp"

#include <gtest/gtest.h>

#include "services/runtime/error.hpp"
#include "tests/support/closed_loop.hpp"

namespace gyrotwin {
namespace {

struct Desk {
  Rig rig = load_rig("double_brennan");
  Integrator owner{rig, 7};
  Controller controller{rig, 42};

  Desk() { follow(7); }

  void follow(std::int64_t epoch) {
    status_t status{};
    status.header.epoch = epoch;
    controller.on_owner(status);
  }

  state_t state(std::int64_t sequence, std::int64_t epoch = 7) const {
    state_t state;
    owner.fill(state);
    state.header = {rig.id, header_t::SIMULATION, epoch, sequence, sequence - 1, 0, 0};
    state.mode = status_t::MODE_RUNNING;
    state.tilt_rad[0] = 0.01;
    return state;
  }
};

TEST(Controller, AnswersAStateWithTheLawsTorques) {
  Desk desk;
  command_t command;
  ASSERT_TRUE(desk.controller.answer(desk.state(5), command));
  EXPECT_EQ(command.mode, command_t::TORQUE_NM);
  EXPECT_EQ(command.for_tick, 4);
  EXPECT_EQ(command.owner_epoch, 7);
  EXPECT_EQ(command.writer, 42);
  EXPECT_EQ(command.counter, 1);
  EXPECT_LE(command.valid_ticks, 10);
  EXPECT_LT(command.value[0], 0.0) << "u = -K x leans against a positive tilt";
  EXPECT_EQ(command.value[2], 0.0);
}

TEST(Controller, FollowsOnlyTheOwnerWhoseStatusItHeard) {
  Desk desk;
  command_t command;
  EXPECT_FALSE(desk.controller.answer(desk.state(1, 8), command));
  desk.follow(8);
  EXPECT_TRUE(desk.controller.answer(desk.state(1, 8), command));
  EXPECT_FALSE(desk.controller.answer(desk.state(2, 7), command)) << "the run before";
}

TEST(Controller, SaysNothingWhileNothingIsToBeCommanded) {
  Desk desk;
  command_t command;
  for (const Mode mode : {Mode::kHeld, Mode::kSafeStop, Mode::kFallen}) {
    state_t state = desk.state(1);
    state.mode = static_cast<std::int32_t>(mode);
    EXPECT_FALSE(desk.controller.answer(state, command)) << name_of(mode);
  }
  state_t blind = desk.state(1);
  blind.valid &= ~state_t::VALID_GIMBALS;
  EXPECT_FALSE(desk.controller.answer(blind, command));
  // An estimate may lack what no law looks at.
  state_t estimate = desk.state(1);
  estimate.valid &= ~state_t::VALID_DISC_TILT;
  estimate.valid &= ~state_t::VALID_ROTORS;
  EXPECT_TRUE(desk.controller.answer(estimate, command));
}

TEST(Controller, RepeatsItsAnswerToARepeatedState) {
  Desk desk;
  command_t first, again;
  ASSERT_TRUE(desk.controller.answer(desk.state(3), first));
  ASSERT_TRUE(desk.controller.answer(desk.state(3), again));
  EXPECT_EQ(again.value[0], first.value[0]);
  EXPECT_EQ(again.for_tick, first.for_tick);
  EXPECT_EQ(again.counter, first.counter + 1);
}

TEST(Controller, NeedsALaw) {
  const Rig rig = load_rig("double_brennan", {"controller.law=none"});
  EXPECT_THROW(Controller(rig, 1), Error);
}

}  // namespace
}  // namespace gyrotwin
