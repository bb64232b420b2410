// The mirror's core: whom it follows, what it makes of repeats, gaps and losses, and how near the
// twin is.
#include "services/mirror/mirror.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "services/runtime/error.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/mirrored_loop.hpp"

namespace gyrotwin {
namespace {

using support::MirroredLoop;

constexpr double kDegree = 0.017453292519943295;

MirroredLoop armed(const std::string& rig) {
  return MirroredLoop(rig, {"loop.state=estimate", "loop.clock=lockstep"});
}

void arm(MirroredLoop& loop) {
  loop.hear();
  ASSERT_EQ(loop.ask(request_t::ARM).result, reply_t::APPLIED);
}

request_t push(const Rig& rig, double share = 1.0) {
  request_t request{};
  request.verb = request_t::DISTURB;
  request.kind = request_t::LOAD;
  request.moment_nm[0] = share * rig.reference_impulse_nms / rig.impulse_duration_s;
  request.duration_ns = std::llround(1e9 * rig.impulse_duration_s);
  return request;
}

template <class Message>
std::string bytes(const Message& message) {
  std::string text(kWireSize<Message>, '\0');
  message.encode(text.data(), 0, static_cast<int>(text.size()));
  return text;
}

double tilt_error(const MirroredLoop& loop, const state_t& twin) {
  const auto& plant = loop.integrator.plant();
  const model::Observation truth = plant.machine().observe(plant.state());
  return std::hypot(twin.tilt_rad[0] - truth.tilt[0], twin.tilt_rad[1] - truth.tilt[1]);
}

class Follows : public testing::TestWithParam<const char*> {};

TEST_P(Follows, ThroughAPush) {
  MirroredLoop loop = armed(GetParam());
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.5);
  ASSERT_EQ(loop.ask(push(loop.rig, 0.5)).result, reply_t::APPLIED);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    loop.hear();
    ASSERT_TRUE(loop.twin_told) << k;
    worst = std::max(worst, tilt_error(loop, loop.twin));
    loop.integrator.advance();
  }
  EXPECT_LT(worst, 0.5 * kDegree);
  EXPECT_EQ(loop.twin.header.sequence, loop.state.header.sequence);
  EXPECT_EQ(loop.twin.mode, status_t::MODE_RUNNING);
}

INSTANTIATE_TEST_SUITE_P(Rigs, Follows, testing::Values("prototype_b", "double_brennan", "gyrocar"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Mirror, HearsNobodyBeforeAnOwner) {
  const Rig rig = load_rig("double_brennan");
  Mirror mirror(rig);
  sensors_t sensors{};
  EXPECT_FALSE(mirror.on_sensors(sensors));
  EXPECT_FALSE(mirror.look_ahead());
}

TEST(Mirror, ARigWithoutSensorsIsRefusedWithTheFix) {
  Rig rig = load_rig("double_brennan");
  rig.sensors.reset();
  try {
    Mirror mirror(rig);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("[sensors]"), std::string::npos) << error.what();
  }
}

TEST(Mirror, ARepeatIsAnsweredWithTheSameBytes) {
  MirroredLoop loop = armed("double_brennan");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.5);
  loop.hear();
  ASSERT_TRUE(loop.twin_told);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(loop.mirror.on_sensors(loop.sensors));
    EXPECT_FALSE(loop.mirror.health_due());
    EXPECT_FALSE(loop.mirror.look_ahead()) << "no time has gone by";
    state_t again;
    loop.mirror.fill(again);
    EXPECT_EQ(bytes(again), bytes(loop.twin));
  }
}

TEST(Mirror, AnOlderOneIsNot) {
  MirroredLoop loop = armed("double_brennan");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.5);
  sensors_t old = loop.sensors;
  loop.tick();
  EXPECT_FALSE(loop.mirror.on_sensors(old));
}

TEST(Mirror, AResetIsANewRun) {
  MirroredLoop loop = armed("double_brennan");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.5);
  ASSERT_EQ(loop.reset().result, reply_t::APPLIED);
  loop.hear();
  EXPECT_EQ(loop.mirror.owner_epoch(), loop.integrator.epoch());
  EXPECT_FALSE(loop.forecast_told);
  ASSERT_EQ(loop.ask(request_t::ARM).result, reply_t::APPLIED);
  loop.run_seconds(2.0);
  EXPECT_TRUE(loop.twin_told);
  EXPECT_LT(tilt_error(loop, loop.twin), 0.3 * kDegree);
}

TEST(Mirror, GoesOnWithoutSomeCommandsAndSensors) {
  MirroredLoop loop = armed("double_brennan");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.5);
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    loop.command_heard = k % 5 != 0;
    loop.hear();
    worst = std::max(worst, tilt_error(loop, loop.twin));
    loop.integrator.advance();
    if (k % 10 != 0) continue;
    // SENSORS that never come: the owner goes on with its last command.
    loop.integrator.on_command(loop.command);
    loop.integrator.advance();
  }
  EXPECT_TRUE(loop.twin_told);
  EXPECT_LT(worst, 0.5 * kDegree);
}

TEST(Mirror, TheLawStandsOnTheTwinAsWell) {
  MirroredLoop loop = armed("prototype_b");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.on_twin = true;
  loop.run_seconds(1.5);
  ASSERT_EQ(loop.ask(push(loop.rig)).result, reply_t::APPLIED);
  loop.run_seconds(4.0);
  EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
  EXPECT_LT(loop.tilt(), 1.0 * kDegree);
}

/// Everything that a mirror hears, in its order.
struct Record {
  std::vector<status_t> owner;
  std::vector<state_t> states;
  std::vector<sensors_t> sensors;
  std::vector<command_t> commands;
};

TEST(Mirror, TheSameMessagesGiveTheSameBytes) {
  MirroredLoop loop = armed("double_brennan");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  Mirror twin(loop.rig);
  status_t status{};
  status.header.epoch = loop.integrator.epoch();
  status.mode = status_t::MODE_RUNNING;
  // What the loop's mirror has heard while HELD.
  twin.on_owner(status);
  status.mode = status_t::MODE_HELD;
  twin.on_owner(status);
  twin.on_state(loop.state);
  twin.on_sensors(loop.sensors);
  twin.look_ahead();

  int forecasts = 0, healths = 0;
  for (int k = 0; k < 1500; ++k) {
    loop.hear();
    twin.on_state(loop.state);
    const bool told = twin.on_sensors(loop.sensors);
    ASSERT_EQ(told, loop.twin_told) << k;
    state_t state;
    if (told) {
      twin.fill(state);
      ASSERT_EQ(bytes(state), bytes(loop.twin)) << k;
    }
    if (twin.health_due()) {
      health_t health;
      twin.fill(health);
      ASSERT_EQ(bytes(health), bytes(loop.health)) << k;
      ++healths;
    }
    if (twin.look_ahead()) {
      forecast_t forecast;
      twin.fill(forecast);
      ASSERT_EQ(bytes(forecast), bytes(loop.forecast)) << k;
      ++forecasts;
    }
    if (loop.commanded) twin.on_command(loop.command);
    loop.integrator.advance();
  }
  EXPECT_GT(healths, 200);
  EXPECT_GT(forecasts, 40);
}

TEST(Mirror, DoesNotAllocate) {
  MirroredLoop loop = armed("prototype_b_sleeping");
  ASSERT_NO_FATAL_FAILURE(arm(loop));
  loop.run_seconds(1.2);
  const AllocationCounter allocations;
  loop.run_seconds(0.2);
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace gyrotwin
