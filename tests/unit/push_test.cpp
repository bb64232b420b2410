#include "clients/disturb/push.hpp"

#include <gtest/gtest.h>

#include "clients/common/tilt.hpp"
#include "clients/disturb/aftermath.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

struct Rounded {
  double asked_s;
  std::int64_t tick_ns;
  std::int64_t ticks;
};

class ImpulseTest : public ::testing::TestWithParam<Rounded> {};
INSTANTIATE_TEST_SUITE_P(
    , ImpulseTest,
    ::testing::Values(Rounded{0.02, kMillisecond, 20}, Rounded{0.0204, kMillisecond, 20},
                      Rounded{0.0206, kMillisecond, 21}, Rounded{0.0001, kMillisecond, 1},
                      Rounded{0.02, 3 * kMillisecond, 7}, Rounded{0.001, 1'234'567, 1}));

TEST_P(ImpulseTest, IsExactHoweverTheDurationIsRounded) {
  const auto [asked_s, tick_ns, ticks] = GetParam();
  const Push impulse{.moment = {1.7, -0.3, 0.9}, .force = {0.1, 20.0, -3.0}};
  const request_t request =
      impulse_request(impulse, {.duration_s = asked_s, .start_tick = 42}, tick_ns);
  EXPECT_EQ(request.verb, request_t::DISTURB);
  EXPECT_EQ(request.disturbance, request_t::IMPULSE);
  EXPECT_EQ(request.start_tick, 42);
  EXPECT_EQ(request.duration_ns, ticks * tick_ns);
  const double duration = 1e-9 * static_cast<double>(request.duration_ns);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(request.moment_nm[i] * duration, impulse.moment[i]);
    EXPECT_DOUBLE_EQ(request.force_n[i] * duration, impulse.force[i]);
  }
}

TEST(Load, StaysUntilClearUnlessADurationIsGiven) {
  const Push load{.moment = {0.5, 0.0, 0.0}, .force = {0.0, 2.0, 0.0}};
  const request_t forever = load_request(load, {}, kMillisecond);
  EXPECT_EQ(forever.disturbance, request_t::STEP_LOAD);
  EXPECT_EQ(forever.duration_ns, 0);
  EXPECT_EQ(forever.moment_nm[0], 0.5);
  EXPECT_EQ(forever.force_n[1], 2.0);
  const request_t limited = load_request(load, {.duration_s = 0.0026}, kMillisecond);
  EXPECT_EQ(limited.duration_ns, 3 * kMillisecond);
  EXPECT_EQ(limited.moment_nm[0], 0.5);
}

TEST(PushText, NamesWhatIsThere) {
  EXPECT_EQ(describe({.moment = {1.0, 0.0, 0.0}}, " s"), "1 N m s about roll");
  EXPECT_EQ(describe({.moment = {0.0, -0.25, 0.0}, .force = {0.0, 0.0, 3.0}}, ""),
            "-0.25 N m about pitch and 3 N along z");
  EXPECT_TRUE(Push{}.nothing());
  EXPECT_FALSE((Push{.force = {0.0, 0.0, 1e-3}}).nothing());
}

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
  EXPECT_EQ(aftermath.text(), "FALLEN after 0.84 s");
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
