// The owner of a real plant, driven by a device that is a few messages: modes, ticks, obedience,
// requests that the device has to answer.
#include "services/hardware/hardware.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/runtime/error.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

/// A device that measures a platform at rest, a little off upright.
struct Device {
  explicit Device(const std::vector<std::string>& overrides = {})
      : rig(load_rig("prototype_b", overrides)), owner(rig, 7) {
    for (const int sensor : std::vector<int>{sensors_t::VALID_GYRO, sensors_t::VALID_ACCELEROMETER,
                                             sensors_t::VALID_DISC, sensors_t::VALID_GIMBALS,
                                             sensors_t::VALID_ROTORS, sensors_t::VALID_ESTOP}) {
      sample.valid |= sensor;
    }
    sample.header.epoch = 99;
    lean(0.01);
    for (double& n : sample.rotor_speed_rad_s) n = 1256.6;
    owner.set_connected(true);
    beat(status_t::MODE_HELD);
    run(600);  // its rate is known
  }

  void lean(double roll) {
    sample.acceleration_m_s2[0] = 0.0;
    sample.acceleration_m_s2[1] = 9.81 * std::sin(roll);
    sample.acceleration_m_s2[2] = 9.81 * std::cos(roll);
  }

  void beat(std::int32_t mode) {
    beat_t beat{};
    beat.header.epoch = sample.header.epoch;
    beat.mode = mode;
    owner.on_beat(beat);
  }

  /// Samples, each answered by a command where `commanded`.
  void run(int samples) {
    for (int i = 0; i < samples; ++i) {
      ++sample.header.tick;
      sample.header.sim_time_ns += period_ns;
      owner.on_sample(sample);
      if (commanded) command(1.0);
    }
  }

  bool command(double torque) {
    command_t command{};
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = 10;
    command.value[0] = torque;
    command.for_tick = owner.tick();
    command.owner_epoch = owner.epoch();
    command.writer = 5;
    command.counter = ++counter;
    return owner.on_command(command);
  }

  reply_t ask(std::int32_t verb, request_t request = {}) {
    request.verb = verb;
    request.owner_epoch = owner.epoch();
    request.writer = 9;
    request.counter = ++asked;
    reply_t reply{};
    answered = owner.on_request(request, {.controller_heard = true, .fresh_epoch = 8}, reply);
    return reply;
  }

  void arm() {
    ASSERT_EQ(ask(request_t::ARM).result, reply_t::APPLIED);
    beat(status_t::MODE_RUNNING);
  }

  std::string why() const { return std::string(owner.why()); }
  /// What STATUS says.
  std::string says() const {
    status_t status{};
    owner.fill(status);
    return get_text(status.text);
  }

  Rig rig;
  Hardware owner;
  sensors_t sample{};
  std::int64_t period_ns = 1'000'000;  // of its samples, by its clock
  bool commanded = false, answered = false;
  std::int64_t counter = 0, asked = 0;
};

TEST(Hardware, RefusesRigsThatCannotBeReal) {
  EXPECT_THROW(Device({"loop.clock=lockstep"}), Error);
  Rig rig = load_rig("prototype_b");
  rig.sensors.reset();
  EXPECT_THROW(Hardware(rig, 1), Error);
}

TEST(Hardware, HeldItKnowsTheTiltAndDoesNotTick) {
  Device device;
  EXPECT_EQ(device.owner.tick(), 0);
  EXPECT_EQ(device.owner.sequence(), 0);
  state_t state{};
  device.owner.fill(state);
  EXPECT_EQ(state.valid & state_t::VALID_TILT, state_t::VALID_TILT);
  EXPECT_NEAR(state.tilt_rad[0], 0.01, 1e-6);
  EXPECT_FALSE(device.command(1.0));
}

TEST(Hardware, TicksAreTheDevicesSamplesAndLeftOutOnesHaveGoneBy) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(5);
  EXPECT_EQ(device.owner.tick(), 5);
  EXPECT_EQ(device.owner.sequence(), 6);
  device.sample.header.tick += 3;
  device.run(1);
  EXPECT_EQ(device.owner.tick(), 9);
  link_t link{};
  device.owner.fill(link);
  EXPECT_EQ(link.samples_missed, 3);
  --device.sample.header.tick;  // an old one
  EXPECT_FALSE(device.owner.on_sample(device.sample));
  EXPECT_EQ(device.owner.tick(), 9);
}

TEST(Hardware, WhatADeviceCannotSayIsNotPlausible) {
  Device device;
  header_t header = device.sample.header;
  header.rig_id = device.rig.id;
  EXPECT_TRUE(device.owner.plausible(header));
  const auto refuses = [&](auto spoil) {
    header_t spoiled = header;
    spoil(spoiled);
    return !device.owner.plausible(spoiled);
  };
  EXPECT_TRUE(refuses([](header_t& h) { ++h.rig_id; }));
  EXPECT_TRUE(refuses([&](header_t& h) { h.epoch = device.owner.epoch(); }));
  EXPECT_TRUE(refuses([](header_t& h) { h.epoch = -1; }));
  EXPECT_TRUE(refuses([](header_t& h) { h.tick = -1; }));
  EXPECT_TRUE(refuses([](header_t& h) { h.sim_time_ns = std::int64_t{1} << 60; }));
  EXPECT_TRUE(refuses([](header_t& h) { h.tick = (std::int64_t{1} << 60) / 1'000'000; }))
      << "its time would not fit 63 bits";
}

TEST(Hardware, CommandsGoOutOnceWithinTheDrivesLimits) {
  Device device;
  device.arm();
  device.run(1);
  ASSERT_TRUE(device.command(1e6));
  const auto out = device.owner.take_command();
  ASSERT_TRUE(out);
  const model::Machine machine = device.rig.build_machine();
  EXPECT_EQ(out->value[0], machine.drives[0].range(0.0)[1]);
  EXPECT_EQ(out->valid_ticks, 10);
  EXPECT_EQ(out->for_tick, device.sample.header.tick);
  EXPECT_FALSE(device.owner.take_command());
}

/// What the motor line gives within the torque limit, and nothing for drives that are not there.
TEST(Hardware, VoltagesAndMissingDrivesAreLimitedToo) {
  Device device({"drive.torque_limit_nm=5"});
  device.arm();
  device.run(1);
  command_t command{};
  command.mode = command_t::VOLTAGE_V;
  command.valid_ticks = 10;
  for (double& value : command.value) value = 24.0;
  command.for_tick = device.owner.tick();
  command.owner_epoch = device.owner.epoch();
  command.writer = 5;
  command.counter = 1;
  ASSERT_TRUE(device.owner.on_command(command));
  const auto out = device.owner.take_command();
  const model::Motor motor = *device.rig.build_machine().drives[0].motor;
  EXPECT_NEAR(motor.torque(out->value[0], 0.0), 5.0, 1e-12);
  for (int i = 1; i < 4; ++i) EXPECT_EQ(out->value[i], 0.0);
}

TEST(Hardware, AnEstopThatIsNoLongerHeardIsPressed) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(5);
  device.sample.valid &= ~static_cast<int>(sensors_t::VALID_ESTOP);
  device.run(1);
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
  EXPECT_EQ(device.ask(request_t::RESET).result, reply_t::REFUSED);
}

TEST(Hardware, ADeviceLongUpHasMissedNothing) {
  Device device;
  device.sample.header.epoch = 100;
  device.sample.header.tick = 5'000'000;
  beat_t beat{};
  beat.header.epoch = 100;
  device.owner.on_beat(beat);  // before its first sample
  device.run(2);
  link_t link{};
  device.owner.fill(link);
  EXPECT_EQ(link.samples_missed, 0);
}

TEST(Hardware, IsNotArmedBeforeTheDeviceHasToldItsMode) {
  Device device;
  device.sample.header.epoch = 100;
  device.run(5);
  EXPECT_EQ(device.ask(request_t::RESET).result, reply_t::APPLIED);
  device.run(1);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::REFUSED);
  device.beat(status_t::MODE_HELD);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::REFUSED) << "nor its rate";
  device.run(600);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::APPLIED);
}

TEST(Hardware, IsNotArmedWhereTheDeviceSamplesAtAnotherRate) {
  for (const auto& [period_ns, drift, armed] :
       {std::tuple{1'000'000, 0.0, true}, std::tuple{1'008'000, 0.0, true},
        std::tuple{1'012'000, 0.0, false}, std::tuple{988'000, 0.0, false},
        std::tuple{4'000'000, 0.0, false}, std::tuple{1'012'000, 0.01, true},
        std::tuple{1'000'000, -0.02, false}}) {
    Device device;
    device.owner.set_clock_drift(drift);
    device.period_ns = period_ns;
    device.run(3000);
    const reply_t reply = device.ask(request_t::ARM);
    EXPECT_EQ(reply.result, armed ? +reply_t::APPLIED : +reply_t::REFUSED) << period_ns;
    EXPECT_EQ(device.says(), armed ? "" : get_text(reply.text)) << "STATUS says it before";
  }
  Device slow;
  slow.period_ns = 4'000'000;
  slow.run(600);
  EXPECT_EQ(get_text(slow.ask(request_t::ARM).text),
            "the device samples at 250.0 Hz, loop.rate_hz is 1000: set its firmware or the rig");
}

TEST(Hardware, ADeviceWhoseRateDriftsIsNamedAndGoesOn) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(600);
  EXPECT_EQ(device.says(), "");
  device.period_ns = 1'020'000;
  device.run(3000);
  EXPECT_EQ(device.owner.mode(), Mode::kRunning);
  EXPECT_NE(device.says().find("980.4 Hz"), std::string::npos) << device.says();
}

/// A device that pauses now and then has its rate all the same, one without stamps none.
TEST(SampleRate, IsThatOfMostPieces) {
  SampleRate rate;
  std::int64_t stamp = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    stamp += tick % 100 == 0 ? 50'000'000 : 1'000'000;
    rate.on_sample(tick, stamp);
  }
  ASSERT_TRUE(rate.known());
  EXPECT_NEAR(rate.hz(), 1000.0, 1e-9);  // measured 0
  rate.forget();
  EXPECT_FALSE(rate.known());
  for (int tick = 0; tick < 4000; ++tick) rate.on_sample(tick, 0);
  EXPECT_FALSE(rate.known());
}

TEST(Hardware, StopsAfterTheTimeoutWithoutCommands) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(20);
  device.commanded = false;
  int ticks = 0;
  for (; device.owner.mode() == Mode::kRunning && ticks < 100; ++ticks) device.run(1);
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
  EXPECT_EQ(ticks, device.rig.safety.command_timeout_ticks);
  beat_t beat{};
  device.owner.fill(beat);
  EXPECT_EQ(beat.mode, status_t::MODE_SAFE_STOP);
}

TEST(Hardware, EstopLatches) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(5);
  device.sample.estop = 1;
  device.run(1);
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
  EXPECT_NE(device.why().find("E-stop"), std::string::npos);
  EXPECT_EQ(device.ask(request_t::RESET).result, reply_t::REFUSED);
  device.sample.estop = 0;
  device.run(1);
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
  EXPECT_EQ(device.ask(request_t::RESET).result, reply_t::APPLIED);
  EXPECT_EQ(device.owner.mode(), Mode::kHeld);
  device.sample.estop = 1;
  device.run(1);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::REFUSED);
}

TEST(Hardware, StopsWithItsDevice) {
  for (const bool restarts : {false, true}) {
    Device device;
    device.arm();
    device.commanded = true;
    device.run(5);
    if (restarts) {
      device.sample.header.epoch = 100;
      device.sample.header.tick = 0;
      device.run(1);
    } else {
      device.beat(status_t::MODE_SAFE_STOP);
    }
    EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
    EXPECT_NE(device.why().find(restarts ? "restarted" : "stopped by itself"), std::string::npos);
  }
}

TEST(Hardware, ADeviceThatDoesNotFollowIsNotArmedAndNotTrusted) {
  Device device;
  device.beat(status_t::MODE_SAFE_STOP);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::REFUSED);
  device.beat(status_t::MODE_HELD);
  ASSERT_EQ(device.ask(request_t::ARM).result, reply_t::APPLIED);
  device.commanded = true;
  for (int i = 0; i < 20; ++i) {
    device.run(10);
    device.beat(status_t::MODE_HELD);
  }
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
}

TEST(Hardware, FallsWhereTheTiltIsBeyondTheLimit) {
  Device device({"estimator.tilt_bandwidth_rad_s=300"});
  device.arm();
  device.commanded = true;
  device.lean(0.9);
  device.run(100);
  EXPECT_EQ(device.owner.mode(), Mode::kFallen);
}

/// Where it lay is forgotten, and from there it is not let go.
TEST(Hardware, IsHeldAnewWhereItIsPropped) {
  Device device;
  device.lean(0.9);
  device.run(3000);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::REFUSED);
  device.lean(0.01);
  EXPECT_EQ(device.ask(request_t::RESET).result, reply_t::APPLIED);
  device.run(10);
  state_t state{};
  device.owner.fill(state);
  EXPECT_NEAR(state.tilt_rad[0], 0.01, 1e-6);
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::APPLIED);
}

TEST(Hardware, ItsTimeNeitherStopsNorIsItPutAnywhere) {
  Device device;
  device.arm();
  for (const int verb :
       std::vector<int>{request_t::PAUSE, request_t::RESUME, request_t::STEP, request_t::SPEED}) {
    const reply_t reply = device.ask(verb);
    EXPECT_EQ(reply.result, reply_t::REFUSED);
    EXPECT_NE(get_text(reply.text).find("real"), std::string::npos);
  }
  request_t request{};
  request.initial_given = 1;
  EXPECT_EQ(device.ask(request_t::RESET, request).result, reply_t::REFUSED);
}

TEST(Hardware, DisturbancesAreTheDevicesToAnswer) {
  Device device;
  device.arm();
  device.commanded = true;
  device.run(50);
  request_t push{};
  push.kind = request_t::LOAD;
  push.start_tick = 70;
  device.ask(request_t::DISTURB, push);
  EXPECT_FALSE(device.answered);
  const auto forwarded = device.owner.take_request();
  ASSERT_TRUE(forwarded);
  EXPECT_EQ(forwarded->start_tick, 70 + device.sample.header.tick - device.owner.tick());
  --device.asked;  // asked again while the device thinks: nothing new
  device.ask(request_t::DISTURB, push);
  EXPECT_FALSE(device.answered);
  EXPECT_FALSE(device.owner.take_request());

  reply_t answer{}, reply{};
  answer.request_writer = forwarded->writer;
  answer.request_counter = forwarded->counter;
  answer.result = reply_t::APPLIED;
  answer.applied_tick = forwarded->start_tick;
  answer.id = 3;
  ASSERT_TRUE(device.owner.on_reply(answer, reply));
  EXPECT_EQ(reply.applied_tick, 70);
  EXPECT_FALSE(device.owner.on_reply(answer, reply));  // once
  --device.asked;                                      // the answer was lost: the same again
  EXPECT_EQ(device.ask(request_t::DISTURB, push).id, 3);
  EXPECT_TRUE(device.answered);
}

TEST(Hardware, ADeviceThatDoesNotAnswerIsARefusal) {
  Device device;
  device.arm();
  request_t push{};
  push.kind = request_t::LOAD;
  device.ask(request_t::DISTURB, push);
  reply_t reply{};
  std::int64_t now = 77'000'000'000;
  EXPECT_FALSE(device.owner.overdue(now, reply));
  EXPECT_FALSE(device.owner.overdue(now + 499'999'999, reply));
  EXPECT_TRUE(device.owner.overdue(now + 500'000'000, reply));
  EXPECT_EQ(reply.result, reply_t::REFUSED);
}

TEST(Hardware, WhatAResetOvertakesIsAnsweredAndNotDone) {
  Device device;
  device.arm();
  device.ask(request_t::DISTURB);
  const std::int64_t push = device.asked;
  ASSERT_EQ(device.ask(request_t::RESET).result, reply_t::APPLIED);
  EXPECT_FALSE(device.owner.take_request());
  reply_t reply{};
  ASSERT_TRUE(device.owner.overdue(77, reply));
  EXPECT_EQ(reply.request_counter, push);
  EXPECT_EQ(reply.result, reply_t::REFUSED);
  EXPECT_NE(get_text(reply.text).find("reset"), std::string::npos);
  EXPECT_FALSE(device.owner.overdue(77, reply));
}

TEST(Hardware, ALateAnswerDoesNotLetANewerRequestBeDoneTwice) {
  Device device;
  device.ask(request_t::CLEAR);
  EXPECT_FALSE(device.answered);
  ASSERT_EQ(device.ask(request_t::ARM).result, reply_t::APPLIED);
  reply_t late{};
  EXPECT_FALSE(device.owner.overdue(1, late));
  ASSERT_TRUE(device.owner.overdue(1'000'000'000, late));
  device.owner.notice(Event::kConflict, "");
  --device.asked;  // the answer to ARM was lost: the same again, which would be refused now
  EXPECT_EQ(device.ask(request_t::ARM).result, reply_t::APPLIED);
  EXPECT_EQ(device.owner.mode(), Mode::kSafeStop);
}

TEST(Hardware, DoesNotAllocate) {
  Device device;
  device.arm();
  device.commanded = true;
  state_t state{};
  sensors_t sensors{};
  status_t status{};
  const AllocationCounter allocations;
  for (int i = 0; i < 20; ++i) {
    device.run(1);
    device.owner.take_command();
    device.owner.fill(state);
    device.owner.fill(sensors);
    device.owner.fill(status);
  }
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace gyrotwin
