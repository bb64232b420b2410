#include "clients/disturb/aftermath.hpp"

#include <gtest/gtest.h>

#include "clients/common/tilt.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

reply_t pushed_at(std::int64_t tick, std::int64_t epoch) {
  reply_t reply{};
  reply.header.epoch = epoch;
  reply.applied_tick = tick;
  return reply;
}

state_t state_at(std::int64_t tick, double roll_deg, std::int32_t mode = status_t::MODE_RUNNING) {
  state_t state{};
  state.header.epoch = 3;
  state.header.tick = tick;
  state.mode = mode;
  state.valid = state_t::VALID_TILT;
  state.tilt_rad[0] = radians(roll_deg);
  return state;
}

TEST(AftermathTest, FindsThePeakAfterThePushAndTheEnd) {
  Aftermath aftermath(pushed_at(100, 3), kMillisecond, 0.2);
  EXPECT_TRUE(aftermath.on(state_at(99, 8.0))) << "time goes on, but it is before the push";
  EXPECT_TRUE(aftermath.on(state_at(130, -2.0)));
  EXPECT_TRUE(aftermath.on(state_at(180, 2.9)));
  EXPECT_FALSE(aftermath.over());
  EXPECT_TRUE(aftermath.on(state_at(300, 0.05)));
  EXPECT_TRUE(aftermath.over());
  EXPECT_FALSE(aftermath.fell());
  EXPECT_EQ(aftermath.text(), "peak 2.900 deg after 0.08 s, 0.050 deg after 0.2 s");
}

TEST(AftermathTest, RepeatsAndOtherRunsAreNoProgress) {
  Aftermath aftermath(pushed_at(100, 3), kMillisecond, 0.2);
  EXPECT_TRUE(aftermath.on(state_at(110, 1.0)));
  EXPECT_FALSE(aftermath.on(state_at(110, 1.0)));
  state_t other_run = state_at(120, 5.0);
  other_run.header.epoch = 4;
  EXPECT_FALSE(aftermath.on(other_run));
}

TEST(AftermathTest, EndsWhereItFalls) {
  Aftermath aftermath(pushed_at(0, 3), kMillisecond, 10.0);
  EXPECT_TRUE(aftermath.on(state_at(840, 41.0, status_t::MODE_FALLEN)));
  EXPECT_TRUE(aftermath.over());
  EXPECT_TRUE(aftermath.fell());
  EXPECT_EQ(aftermath.text(), "FALLEN after 0.84 s; `gyrotwin ctl reset`, then `gyrotwin ctl arm`");
}

TEST(AftermathTest, SaysSoWhereItHasStopped) {
  Aftermath aftermath(pushed_at(100, 3), kMillisecond, 0.2);
  EXPECT_TRUE(aftermath.on(state_at(300, 0.5, status_t::MODE_SAFE_STOP)));
  EXPECT_TRUE(aftermath.over());
  EXPECT_EQ(aftermath.text(),
            "peak 0.500 deg after 0.2 s, 0.500 deg after 0.2 s; SAFE_STOP, `gyrotwin ctl status` "
            "says why");
}

TEST(AftermathTest, SaysSoWhereThereIsNoTilt) {
  Aftermath aftermath(pushed_at(100, 3), kMillisecond, 0.2);
  state_t state = state_at(300, 0.0);
  state.valid = 0;
  EXPECT_TRUE(aftermath.on(state));
  EXPECT_TRUE(aftermath.over());
  EXPECT_EQ(aftermath.text(), "STATE tells no tilt to watch");
}

TEST(Tilt, IsTheAngleOfTheAxis) {
  state_t state{};
  EXPECT_EQ(tilt_of(state), 0.0);
  state.tilt_rad[0] = 1e-9;
  state.tilt_rad[1] = -1e-9;
  EXPECT_NEAR(tilt_of(state), std::sqrt(2.0) * 1e-9, 1e-21) << "small tilts are not lost";
  state.tilt_rad[0] = 0.3;
  state.tilt_rad[1] = -0.4;
  EXPECT_NEAR(tilt_of(state), std::acos(std::cos(0.3) * std::cos(0.4)), 1e-14);
  state.tilt_rad[0] = 2.0;
  state.tilt_rad[1] = 0.0;
  EXPECT_DOUBLE_EQ(tilt_of(state), 2.0) << "beyond the horizontal";
}

}  // namespace
}  // namespace gyrotwin
