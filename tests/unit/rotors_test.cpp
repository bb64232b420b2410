// Flywheels that run up and coast down when asked, also while the plant is held.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "services/integrator/integrator.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/schedule_bench.hpp"

namespace gyrotwin {
namespace {

using support::ClosedLoop;
using support::with_everything;

TEST(Rotors, AreNotToldOfWhereTheyKeepTheirSpeed) {
  Rig rig = load_rig("prototype_b");
  rig.rotor_drive.reset();
  Integrator owner(rig, 1);
  request_t up{};
  up.verb = request_t::ROTORS;
  up.kind = request_t::SPIN_UP;
  up.owner_epoch = 1;
  up.writer = up.counter = 1;
  reply_t reply;
  owner.on_request(up, {}, reply);
  EXPECT_EQ(reply.result, reply_t::REFUSED);
}

TEST(Rotors, RunUpWhileThePlantIsHeld) {
  ClosedLoop loop("prototype_b", with_everything({"rotor_drive.start_share=0.2"}));
  const Integrator& owner = loop.integrator;
  const model::State before = owner.plant().state();
  const double nominal = owner.plant().machine().nominal_rotor_speed[0];
  EXPECT_EQ(before.rotor_speed[0], 0.2 * nominal);
  EXPECT_FALSE(loop.integrator.hold(1.0)) << "nobody asked";

  request_t rotors{};
  rotors.kind = request_t::SPIN_UP;
  const reply_t reply = loop.ask(request_t::ROTORS, rotors);
  ASSERT_EQ(reply.result, reply_t::APPLIED) << get_text(reply.text);
  double told = 0.0;
  ASSERT_EQ(std::sscanf(reinterpret_cast<const char*>(reply.text),
                        "spin up: 99 %% of nominal speed in about %lf s", &told),
            1)
      << get_text(reply.text);
  double taken = 0.0;
  while (owner.plant().state().rotor_speed[0] < 0.99 * nominal && taken < 100.0) {
    ASSERT_TRUE(loop.integrator.hold(0.02));
    taken += 0.02;
  }
  EXPECT_NEAR(told, taken, 0.06 * taken);  // two digits are told; measured 0
  EXPECT_EQ(owner.tick(), 0);
  EXPECT_TRUE(owner.plant().state().q == before.q && owner.plant().state().v == before.v);
  state_t state{};
  owner.fill(state);
  EXPECT_EQ(state.rotor_speed_rad_s[3], owner.plant().state().rotor_speed[3]) << "STATE 0 has it";

  ASSERT_EQ(loop.ask(request_t::RESET).result, reply_t::APPLIED);
  EXPECT_EQ(owner.plant().state().rotor_speed[0], 0.2 * nominal);
  EXPECT_FALSE(loop.integrator.hold(1.0)) << "a new run";
  const reply_t armed = loop.ask(request_t::ARM);
  EXPECT_NE(get_text(armed.text).find("rotors at 20 %"), std::string::npos) << get_text(armed.text);
  EXPECT_FALSE(loop.integrator.hold(1.0)) << "running";
}

TEST(Rotors, StayOffUntilTheyAreAskedUp) {
  ClosedLoop loop("prototype_b", with_everything());
  loop.arm();
  request_t rotors{};
  rotors.kind = request_t::SPIN_DOWN;
  const reply_t reply = loop.ask(request_t::ROTORS, rotors);
  ASSERT_EQ(reply.result, reply_t::APPLIED) << get_text(reply.text);
  EXPECT_NE(get_text(reply.text).find("coast down: 1 % of nominal speed in about"),
            std::string::npos)
      << get_text(reply.text);
  const auto speed = [&] { return loop.integrator.plant().state().rotor_speed[0]; };
  const double nominal = speed();
  loop.run_seconds(1.0);
  const double slower = speed();
  EXPECT_LT(slower, 0.99 * nominal);
  rotors.kind = request_t::SPIN_UP;
  ASSERT_EQ(loop.ask(request_t::ROTORS, rotors).result, reply_t::APPLIED);
  loop.run_seconds(0.1);
  EXPECT_GT(speed(), slower);
  rotors.kind = 3;
  EXPECT_EQ(loop.ask(request_t::ROTORS, rotors).result, reply_t::REFUSED);
}

TEST(Rotors, GoOnRunningDownWhereItLies) {
  ClosedLoop loop("double_brennan", with_everything({"initial.q=[0.3, 0.2, 0.0, 0.0]"}));
  loop.arm();
  loop.controller_alive = false;
  request_t rotors{};
  rotors.kind = request_t::SPIN_DOWN;
  ASSERT_EQ(loop.ask(request_t::ROTORS, rotors).result, reply_t::APPLIED);
  loop.run_seconds(20.0);
  ASSERT_TRUE(loop.integrator.plant().state().v.isZero(0)) << "lies";
  const double before = loop.integrator.plant().state().rotor_speed[0];
  loop.run_seconds(1.0);
  EXPECT_LT(std::abs(loop.integrator.plant().state().rotor_speed[0]), std::abs(before));
}

}  // namespace
}  // namespace gyrotwin
