// The owner in trouble: commands that do not arrive, sensors that lie; and that all of it is
// repeatable.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "services/integrator/integrator.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/schedule_bench.hpp"

namespace gyrotwin {
namespace {

using support::ClosedLoop;
using support::with_everything;

status_t status_of(const Integrator& owner) {
  status_t status{};
  owner.fill(status);
  return status;
}

TEST(CommandLost, EndsInASafeStopAfterTheTimeoutOnEveryPacedClock) {
  for (const char* clock : {"realtime", "lockstep"}) {
    ClosedLoop loop("double_brennan", {std::string("loop.clock=") + clock});
    loop.arm();
    loop.run_ticks(100);
    request_t cut{};
    cut.kind = request_t::COMMAND_LOST;
    cut.start_tick = 150;
    const reply_t reply = loop.ask(request_t::FAULT, cut);
    ASSERT_EQ(reply.result, reply_t::APPLIED) << get_text(reply.text);
    EXPECT_EQ(reply.applied_tick, 150);
    EXPECT_EQ(status_of(loop.integrator).faults, 1);
    loop.run_ticks(51);
    EXPECT_EQ(loop.integrator.mode(), Mode::kRunning);
    EXPECT_NE(get_text(status_of(loop.integrator).text).find("command link"), std::string::npos);
    while (loop.integrator.mode() == Mode::kRunning) loop.run_ticks(1);
    EXPECT_EQ(loop.integrator.mode(), Mode::kSafeStop) << clock;
    EXPECT_EQ(loop.integrator.tick() - 1 - 149, loop.rig.safety.command_timeout_ticks) << clock;
    const status_t status = status_of(loop.integrator);
    EXPECT_EQ(status.refused_not_finite + status.refused_epoch + status.refused_expired +
                  status.refused_counter + status.refused_writer,
              0);
  }
}

TEST(CommandLost, IsStillToldWhenItHasFallen) {
  ClosedLoop loop("double_brennan");
  loop.arm();
  loop.run_ticks(100);
  loop.controller_alive = false;
  for (int i = 0; i < 20'000 && loop.integrator.mode() != Mode::kFallen; ++i) loop.run_ticks(1);
  ASSERT_EQ(loop.integrator.mode(), Mode::kFallen);
  EXPECT_EQ(get_text(status_of(loop.integrator).text),
            "fell after the stop: no valid command in time; start the controller, then reset and "
            "arm");
}

TEST(CommandLost, IsSurvivedWhenItIsShort) {
  for (const char* clock : {"realtime", "lockstep"}) {
    ClosedLoop loop("double_brennan", {std::string("loop.clock=") + clock});
    loop.arm();
    loop.run_ticks(100);
    request_t cut{};
    cut.kind = request_t::COMMAND_LOST;
    cut.duration_ns = (loop.rig.safety.command_timeout_ticks - 1) * loop.rig.loop.tick_ns();
    ASSERT_EQ(loop.ask(request_t::FAULT, cut).result, reply_t::APPLIED);
    loop.run_ticks(200);
    EXPECT_EQ(loop.integrator.mode(), Mode::kRunning) << clock;
    EXPECT_EQ(loop.integrator.tick(), 300);
    EXPECT_EQ(status_of(loop.integrator).faults, 0);
  }
}

TEST(CommandLost, LockstepGoesOnWithTheCommandThatDoesNotAct) {
  ClosedLoop loop("double_brennan", {"loop.clock=lockstep"});
  loop.arm();
  request_t cut{};
  cut.kind = request_t::COMMAND_LOST;
  ASSERT_EQ(loop.ask(request_t::FAULT, cut).result, reply_t::APPLIED);
  EXPECT_FALSE(loop.integrator.answered());
  command_t command{};
  command.mode = command_t::TORQUE_NM;
  command.valid_ticks = 5;
  command.writer = command.counter = 1;
  command.owner_epoch = loop.integrator.epoch() + 1;
  EXPECT_FALSE(loop.integrator.on_command(command));
  EXPECT_FALSE(loop.integrator.answered()) << "for another run";
  command.owner_epoch = loop.integrator.epoch();
  EXPECT_FALSE(loop.integrator.on_command(command)) << "not obeyed";
  EXPECT_TRUE(loop.integrator.answered());
  loop.integrator.advance();
  EXPECT_EQ(loop.integrator.tick(), 1);
  EXPECT_FALSE(loop.integrator.answered());
}

TEST(Troubles, AreCancelledAndClearedByNumber) {
  ClosedLoop loop("prototype_b");
  loop.arm();
  request_t load{};
  load.kind = request_t::LOAD;
  load.moment_nm[0] = 1.0;
  EXPECT_EQ(loop.ask(request_t::DISTURB, load).id, 1);
  EXPECT_EQ(loop.ask(request_t::DISTURB, load).id, 2);
  request_t weak{};
  weak.kind = request_t::DRIVE_WEAK;
  weak.level = 0.5;
  EXPECT_EQ(loop.ask(request_t::FAULT, weak).id, 3);
  EXPECT_EQ(status_of(loop.integrator).disturbances, 2);
  EXPECT_EQ(status_of(loop.integrator).faults, 1);

  request_t cancel{};
  cancel.id = 1;
  EXPECT_EQ(loop.ask(request_t::CANCEL, cancel).result, reply_t::APPLIED);
  EXPECT_EQ(loop.ask(request_t::CANCEL, cancel).result, reply_t::REFUSED);
  EXPECT_EQ(status_of(loop.integrator).disturbances, 1);
  loop.ask(request_t::CLEAR);
  EXPECT_EQ(status_of(loop.integrator).disturbances + status_of(loop.integrator).faults, 0);
  EXPECT_EQ(loop.ask(request_t::DISTURB, load).id, 4);
  loop.ask(request_t::RESET);
  loop.arm();
  EXPECT_EQ(loop.ask(request_t::DISTURB, load).id, 1) << "a new run";
}

TEST(Estimate, IsWhatStateShows) {
  ClosedLoop loop("prototype_b", {"loop.state=estimate"});
  loop.arm();
  loop.run_ticks(200);
  state_t state{};
  loop.integrator.fill(state);
  const model::Machine& machine = loop.integrator.plant().machine();
  const model::Observation truth = machine.observe(loop.integrator.plant().state());
  EXPECT_NE(state.tilt_rad[0], truth.tilt[0]);
  EXPECT_NEAR(state.tilt_rad[0], truth.tilt[0], 0.02);
  EXPECT_TRUE(state.valid & state_t::VALID_DRIVES);

  // The drive's torque comes from its current.
  sensors_t sensors{};
  loop.integrator.fill(sensors);
  const model::Motor& motor = *machine.drives[0].motor;
  EXPECT_EQ(state.drive_torque_nm[0],
            motor.torque_constant * motor.gear_ratio * sensors.drive_current_a[0]);
  EXPECT_NE(state.drive_torque_nm[0], 0.0);

  // Where no current is heard, it is what was asked for.
  request_t dropped{};
  dropped.kind = request_t::SENSOR_DROPPED;
  dropped.target = sensors_t::VALID_CURRENTS;
  ASSERT_EQ(loop.ask(request_t::FAULT, dropped).result, reply_t::APPLIED);
  loop.run_ticks(1);
  loop.integrator.fill(state);
  loop.integrator.fill(sensors);
  EXPECT_EQ(sensors.drive_current_a[0], 0.0);
  EXPECT_FALSE(sensors.valid & sensors_t::VALID_CURRENTS);
  EXPECT_NE(state.drive_torque_nm[0], 0.0);
}

TEST(Estimate, ASensorFaultReachesStateAndNotThePlant) {
  ClosedLoop loop("prototype_b", {"loop.state=estimate"});
  loop.arm();
  request_t biased{};
  biased.kind = request_t::SENSOR_BIASED;
  biased.target = sensors_t::VALID_ROTORS;
  biased.level = 50.0;
  ASSERT_EQ(loop.ask(request_t::FAULT, biased).result, reply_t::APPLIED);
  loop.run_ticks(20);
  state_t state{};
  loop.integrator.fill(state);
  const double truth = loop.integrator.plant().state().rotor_speed[0];
  EXPECT_GT(state.rotor_speed_rad_s[0], truth + 20.0);
}

TEST(Truth, TellsWhatActs) {
  ClosedLoop loop("double_brennan", with_everything());
  loop.arm();
  const auto disturb = [&](request_t request) {
    ASSERT_EQ(loop.ask(request_t::DISTURB, request).result, reply_t::APPLIED);
  };
  request_t turn{};
  turn.kind = request_t::TURN;
  turn.speed_m_s = 10.0;
  turn.yaw_rate_rad_s = 0.1;
  disturb(turn);
  request_t mass{};
  mass.kind = request_t::ADDED_MASS;
  mass.position_m[2] = 0.4;
  for (const double kg : {0.5, 0.25}) {
    mass.mass_kg = kg;
    disturb(mass);
  }
  loop.run_ticks(1);
  truth_t truth{};
  loop.integrator.fill(truth);
  EXPECT_EQ(truth.yaw_rate_rad_s, 0.1);
  EXPECT_EQ(truth.ground_acceleration_m_s2[1], 1.0);
  EXPECT_EQ(truth.added_mass_kg, 0.75);
  const model::State& state = loop.integrator.plant().state();
  for (int i = 0; i < model::kMaxCoordinates; ++i) {
    EXPECT_EQ(truth.q[i], state.q[i]);
    EXPECT_EQ(truth.v[i], state.v[i]);
  }
}

TEST(Owner, OfEveryShippedRigRunsAndSenses) {
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name, {"loop.clock=free"});
    Integrator owner(rig, 1);
    request_t arm{};
    arm.verb = request_t::ARM;
    arm.owner_epoch = arm.writer = arm.counter = 1;
    reply_t reply;
    owner.on_request(arm, {}, reply);
    ASSERT_EQ(reply.result, reply_t::APPLIED) << name << get_text(reply.text);
    for (int tick = 0; tick < 200; ++tick) owner.advance();
    EXPECT_EQ(owner.mode(), Mode::kRunning) << name << ": " << owner.why();
    sensors_t sensors{};
    owner.fill(sensors);
    EXPECT_EQ(owner.has_sensors(), (sensors.valid & sensors_t::VALID_GYRO) != 0) << name;
    EXPECT_TRUE(std::isfinite(sensors.acceleration_m_s2[2])) << name;
  }
}

/// One of each, early enough to matter.
std::vector<request_t> all_troubles() {
  std::vector<request_t> all;
  const auto disturb = [&](std::int32_t kind) -> request_t& {
    all.push_back(support::disturbance(kind));
    all.back().start_tick = 1 + 10 * static_cast<std::int64_t>(all.size());
    all.back().duration_ns = 300'000'000;
    return all.back();
  };
  disturb(request_t::LOAD).moment_nm[0] = 0.5;
  request_t& sine = disturb(request_t::SINE);
  sine.force_n[1] = 0.5;
  sine.frequency_hz[0] = 3.0;
  request_t& chirp = disturb(request_t::CHIRP);
  chirp.moment_nm[0] = 0.3;
  chirp.frequency_hz[1] = 30.0;
  request_t& gust = disturb(request_t::GUST);
  gust.moment_nm[0] = 0.3;
  gust.correlation_s = 0.1;
  gust.seed = 1;
  request_t& wind = disturb(request_t::WIND);
  wind.speed_m_s = 1.0;
  wind.turbulence_m_s = 0.2;
  wind.length_m = 1.0;
  wind.direction_rad = 1.0;
  request_t& turn = disturb(request_t::TURN);
  turn.speed_m_s = 1.0;
  turn.yaw_rate_rad_s = 0.1;
  disturb(request_t::DECELERATION).deceleration_m_s2 = 0.05;
  request_t& mass = disturb(request_t::ADDED_MASS);
  mass.mass_kg = 0.05;
  mass.position_m[2] = 0.3;

  const auto fail = [&](std::int32_t kind, std::int32_t target) -> request_t& {
    all.push_back(support::fault(kind, target));
    all.back().start_tick = 1 + 10 * static_cast<std::int64_t>(all.size());
    all.back().duration_ns = 100'000'000;
    return all.back();
  };
  fail(request_t::SENSOR_STUCK, sensors_t::VALID_GYRO).duration_ns = 5'000'000;
  fail(request_t::SENSOR_BIASED, sensors_t::VALID_GYRO).level = 0.01;
  request_t& noisy = fail(request_t::SENSOR_NOISY, sensors_t::VALID_ACCELEROMETER);
  noisy.level = 0.5;
  noisy.seed = 3;
  fail(request_t::SENSOR_DROPPED, sensors_t::VALID_ACCELEROMETER);
  fail(request_t::SENSOR_DELAYED, sensors_t::VALID_GIMBALS).delay_ns = 2'000'000;
  fail(request_t::DRIVE_WEAK, 0).level = 0.9;
  fail(request_t::ROTOR_LOSS, 0).level = 0.001;
  fail(request_t::COMMAND_LOST, 0).duration_ns = 3'000'000;
  return all;
}

// Byte by byte, everything that is sent.
TEST(Troubles, AllOfThemAreRepeatableToTheLastBit) {
  const auto run = [](const char* state) {
    ClosedLoop loop("prototype_b", with_everything({std::string("loop.state=") + state}));
    for (const request_t& trouble : all_troubles()) {
      const reply_t reply = loop.ask(trouble.verb, trouble);
      EXPECT_EQ(reply.result, reply_t::APPLIED) << get_text(reply.text);
    }
    loop.arm();
    std::vector<std::uint8_t> bytes;
    const auto append = [&bytes](const auto& message) {
      const std::size_t at = bytes.size();
      bytes.resize(at + static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), static_cast<int>(at), message.getEncodedSize());
    };
    state_t shown{};
    sensors_t sensors{};
    truth_t truth{};
    for (int tick = 0; tick < 1000; ++tick) {
      loop.run_ticks(1);
      loop.integrator.fill(shown);
      loop.integrator.fill(sensors);
      loop.integrator.fill(truth);
      append(shown);
      append(sensors);
      append(truth);
    }
    EXPECT_EQ(loop.integrator.mode(), Mode::kRunning) << loop.integrator.why();
    EXPECT_EQ(status_of(loop.integrator).disturbances + status_of(loop.integrator).faults, 0);
    return bytes;
  };
  const auto truth = run("truth");
  EXPECT_TRUE(truth == run("truth"));
  const auto estimate = run("estimate");
  EXPECT_TRUE(estimate == run("estimate"));
  EXPECT_FALSE(truth == estimate);
}

}  // namespace
}  // namespace gyrotwin
