// An emulated rig, by its bytes alone: a host in this file holds it, lets it run, balances it, and
// meets every trouble. Time is counted, not waited for.
#include <gtest/gtest.h>

#include <cmath>

#include "clients/rig_emulator/emulator.hpp"
#include "services/controller/law.hpp"
#include "services/onboard/estimator.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/line_frames.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kOwner = 1234;  // the host's epoch
constexpr std::int64_t kStart = 7'000'000'000;

/// The host's side, and both in step: one tick of the rig, what it says, what the host answers.
class Host {
 public:
  explicit Host(const std::string& name, const std::vector<std::string>& overrides = {})
      : rig(load_rig(name, overrides)),
        emulator(rig, 99, kStart),
        machine_(rig.build_machine()),
        estimator_(rig, machine_),
        law_(rig, machine_) {
    estimator_.reset(machine_.observe(rig.initial_state(machine_)));
    law_.reset(machine_.observe(rig.initial_state(machine_)));
    beat.header.rig_id = command.header.rig_id = request.header.rig_id = rig.id;
    beat.header.epoch = command.owner_epoch = kOwner;
    beat.command_timeout_ticks = rig.safety.command_timeout_ticks;
    beat.safe_stop = beat_t::ZERO_TORQUE;
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = rig.safety.command_timeout_ticks;
    request.writer = 3;
  }

  void tick() {
    now += rig.loop.tick_ns();
    emulator.tick(now);
    for (const FrameBytes& payload : unframer.take(all_that_is_sent())) hear(payload);
    if (emulator.plant().tick() % 10 == 0) send(beat);
  }
  void run(double seconds) {
    for (std::int64_t k = std::llround(seconds / rig.loop.tick_s()); k > 0; --k) tick();
  }
  void say(std::int32_t mode) {
    beat.mode = mode;
    send(beat);
  }
  void arm() {
    say(status_t::MODE_HELD);
    say(status_t::MODE_RUNNING);
  }
  template <class Message>
  void send(const Message& message) {
    if (emulator.reads()) emulator.receive(frame_of(message), now);
  }
  reply_t ask(std::int32_t verb, std::int32_t kind) {
    request.verb = verb;
    request.kind = kind;
    ++request.counter;
    reply = {};
    send(request);
    for (const FrameBytes& payload : unframer.take(all_that_is_sent())) hear(payload);
    return reply;
  }
  double tilt_deg() const {
    return emulator.plant().machine().tilt(emulator.plant().state()) * 180.0 / M_PI;
  }

  Rig rig;
  Emulator emulator;
  std::int64_t now = kStart;
  beat_t beat{};
  command_t command{};
  request_t request{};
  bool commands = true;  // the law answers
  bool listens = true;   // the host reads
  Unframer unframer;
  sensors_t sensors{};  // the newest
  beat_t device{};      // likewise
  reply_t reply{};
  std::int64_t samples = 0, missed = 0;

 private:
  FrameBytes all_that_is_sent() {
    FrameBytes bytes;
    while (listens && !emulator.outgoing().empty()) {
      const auto some = emulator.outgoing();
      bytes.insert(bytes.end(), some.begin(), some.end());
      emulator.sent(some.size());
    }
    return bytes;
  }

  void hear(const FrameBytes& payload) {
    if (decode(payload, device)) beat.echo_ns = device.sent_ns;
    decode(payload, reply);
    const std::int64_t before = sensors.header.tick;
    const std::int64_t epoch = sensors.header.epoch;
    if (!decode(payload, sensors)) return;
    if (samples > 0 && sensors.header.epoch == epoch) missed += sensors.header.tick - before - 1;
    ++samples;
    estimator_.step(sensors);
    if (!commands || beat.mode != status_t::MODE_RUNNING) return;
    const auto torques = law_.step(estimator_.seen());
    std::copy(torques.begin(), torques.end(), std::begin(command.value));
    command.for_tick = sensors.header.tick;
    send(command);
  }

  model::Machine machine_;
  OnboardEstimator estimator_;
  SampledLaw law_;
};

TEST(RigEmulator, HeldItIsProppedAndOnlyTheDiscTurns) {
  Host host("prototype_b");
  host.say(status_t::MODE_HELD);
  const model::State before = host.emulator.plant().state();
  host.run(0.5);
  const model::State& after = host.emulator.plant().state();
  const int disc = host.emulator.plant().machine().layout.disc;
  for (int i = 0; i < 4; ++i) {
    const double turned = i == disc ? 0.5 * before.v[disc] : 0.0;
    EXPECT_NEAR(after.q[i] - before.q[i], turned, 1e-9) << i;  // measured 4e-14
    EXPECT_EQ(after.v[i], before.v[i]);
  }
  EXPECT_EQ(host.samples, 500);
  EXPECT_EQ(host.device.mode, status_t::MODE_HELD);
  // The encoder shows that it turns, so that who estimates its speed knows it when it is let go.
  EXPECT_NEAR(host.sensors.disc_angle_rad, after.q[disc], 0.01);
}

class Balance : public testing::TestWithParam<const char*> {};

TEST_P(Balance, StandsByCommandsOverTheLine) {
  Host host(GetParam());
  host.say(status_t::MODE_HELD);
  host.run(0.1);
  host.arm();
  host.run(10.0);
  EXPECT_EQ(host.device.mode, status_t::MODE_RUNNING);
  EXPECT_LT(host.tilt_deg(), 3.0);
  EXPECT_EQ(host.missed, 0);
  EXPECT_EQ(host.device.frames_bad, 0);
  EXPECT_EQ(host.device.frames_dropped, 0);
  EXPECT_EQ(host.unframer.bad(), 0);
  EXPECT_NEAR(static_cast<double>(host.device.commands_obeyed), 10.0 * host.rig.loop.rate_hz, 20.0);
  EXPECT_EQ(host.device.safe_stops, 0);
}

INSTANTIATE_TEST_SUITE_P(Rigs, Balance,
                         testing::Values("prototype_b", "double_brennan", "brennan_monorail"),
                         [](const auto& test) { return std::string(test.param); });

TEST(RigEmulator, WithoutCommandsItStopsAndFallsAndIsPutBack) {
  Host host("double_brennan");
  host.beat.safe_stop = beat_t::BRAKE;  // as its file says
  host.beat.safe_stop_gain = host.rig.safety.gain;
  host.arm();
  host.run(1.0);
  ASSERT_EQ(host.device.mode, status_t::MODE_RUNNING);
  host.commands = false;
  for (int k = 0; k < host.rig.safety.command_timeout_ticks; ++k) {
    host.tick();
    ASSERT_EQ(host.emulator.device().mode, status_t::MODE_RUNNING) << k;
  }
  host.tick();
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_SAFE_STOP);
  host.run(10.0);
  EXPECT_GT(host.tilt_deg(), 79.0) << "it lies";
  const auto lying = host.emulator.plant().state();
  host.run(0.1);
  EXPECT_EQ(host.emulator.plant().state().q, lying.q);
  EXPECT_EQ(host.device.safe_stops, 1);

  host.say(status_t::MODE_HELD);
  host.tick();
  EXPECT_LT(host.tilt_deg(), 3.0) << "propped up again";
  EXPECT_TRUE(host.emulator.plant().sound());
}

TEST(RigEmulator, IsPushedByRequestAndSaysWhenInTheDevicesTicks) {
  Host host("prototype_b");
  host.say(status_t::MODE_HELD);
  host.run(0.05);
  EXPECT_EQ(host.ask(request_t::DISTURB, request_t::LOAD).result, reply_t::REFUSED);
  host.arm();
  host.run(0.5);
  host.request.moment_nm[0] = 50.0;
  host.request.duration_ns = 20'000'000;
  const reply_t reply = host.ask(request_t::DISTURB, request_t::LOAD);
  ASSERT_EQ(reply.result, reply_t::APPLIED);
  EXPECT_EQ(reply.id, 1);
  // SENSORS k is out, so that tick k is the next.
  EXPECT_EQ(reply.applied_tick, host.sensors.header.tick);
  host.tick();
  EXPECT_EQ(host.emulator.plant().input().moment.x(), 50.0);

  host.request.start_tick = host.sensors.header.tick + 30;
  const reply_t later = host.ask(request_t::DISTURB, request_t::LOAD);
  ASSERT_EQ(later.result, reply_t::APPLIED);
  EXPECT_EQ(later.applied_tick, host.request.start_tick);
  host.run(0.030);
  EXPECT_EQ(host.emulator.plant().input().moment.x(), 0.0);
  host.tick();
  EXPECT_EQ(host.emulator.plant().input().moment.x(), 50.0);

  host.request.start_tick = 0;
  host.request.duration_ns = 0;
  host.request.id = later.id;
  host.request.moment_nm[0] = 0.0;
  EXPECT_EQ(host.ask(request_t::CANCEL, 0).result, reply_t::APPLIED);
  EXPECT_EQ(host.ask(request_t::CLEAR, 0).result, reply_t::APPLIED);
  EXPECT_EQ(host.ask(request_t::CANCEL, 0).result, reply_t::REFUSED) << "it is over";
  EXPECT_EQ(host.ask(request_t::ARM, 0).result, reply_t::REFUSED) << "the owner's business";
}

TEST(RigEmulator, SensorsFailByRequest) {
  Host host("prototype_b");
  host.arm();
  host.run(0.1);
  host.request.target = sensors_t::VALID_GYRO;
  ASSERT_EQ(host.ask(request_t::FAULT, request_t::SENSOR_DROPPED).result, reply_t::APPLIED);
  host.run(0.01);
  EXPECT_FALSE(host.sensors.valid & sensors_t::VALID_GYRO);
  EXPECT_TRUE(host.sensors.valid & sensors_t::VALID_ACCELEROMETER);
}

TEST(RigEmulator, EstopIsPressedAndReleased) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("estop@0.2+0.1", 0.0));
  host.arm();
  host.run(0.199);
  ASSERT_EQ(host.emulator.device().mode, status_t::MODE_RUNNING);
  host.tick();
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_SAFE_STOP);
  EXPECT_EQ(host.sensors.estop, 1);
  host.run(0.05);
  host.arm();
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_SAFE_STOP) << "still pressed";
  host.run(0.06);
  EXPECT_EQ(host.sensors.estop, 0);
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_SAFE_STOP) << "latched";
  host.arm();
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_RUNNING);
}

TEST(RigEmulator, ASilentLineIsASafeStopAndNoDamage) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("silent@0.2+0.3", 0.0));
  host.arm();
  host.run(0.6);
  EXPECT_EQ(host.emulator.device().stop, GYROTWIN_STOP_COMMANDS);
  EXPECT_EQ(host.missed, 300);
  EXPECT_EQ(host.sensors.header.tick, host.emulator.device().samples - 1);
  // Cut in the middle of nothing: what went out before was whole.
  EXPECT_EQ(host.unframer.bad(), 0);
}

TEST(RigEmulator, HalfFramesAreBadFrames) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("halves@0.1+0.2", 0.0));
  host.arm();
  host.run(0.5);
  EXPECT_GT(host.unframer.bad(), 0);
  EXPECT_GE(host.missed, 200);
  EXPECT_LE(host.missed, 202) << "and with its end they are over";
  EXPECT_GT(host.emulator.device().decoder.bad, 0) << "both ways";
}

TEST(RigEmulator, FlippedBitsCostFramesAndNothingPasses) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("flips@0.1+5=0.0005", 0.0));
  host.arm();
  host.run(5.2);
  // A sample of 270 bytes is hit with probability 1 - 0.9995^270 = 0.126.
  EXPECT_NEAR(static_cast<double>(host.missed) / 5000.0, 0.126, 0.02);
  EXPECT_GT(host.emulator.device().decoder.bad, 100);
  EXPECT_EQ(host.emulator.device().frames_refused, 0);
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_RUNNING) << "one command in ten ticks";
}

TEST(RigEmulator, ADeafDeviceStopsItself) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("deaf@0.1+0.1", 0.0));
  host.arm();
  host.run(0.3);
  EXPECT_EQ(host.emulator.device().stop, GYROTWIN_STOP_COMMANDS);
  EXPECT_EQ(host.missed, 0) << "it speaks on";
}

TEST(RigEmulator, AHostThatDoesNotReadHoldsNothingUp) {
  Host host("prototype_b");
  host.say(status_t::MODE_HELD);
  host.listens = false;
  host.run(2.0);
  EXPECT_EQ(host.emulator.plant().tick(), 2000);
  EXPECT_LE(host.emulator.outgoing().size(), 4096u);
  EXPECT_GT(host.emulator.device().outbox.dropped, 1900);
  host.listens = true;
  host.run(0.1);
  EXPECT_EQ(host.unframer.bad(), 0);
  EXPECT_EQ(host.sensors.header.tick, 2099);
}

TEST(RigEmulator, ARestartedFirmwareIsAnotherRunAndThePlantGoesOn) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("restart@0.301", 0.0));  // between two beats
  host.emulator.cause(parse_trouble("silent@0.302+0.02", 0.0));
  host.arm();
  host.run(0.300);
  const std::int64_t epoch = host.sensors.header.epoch;
  const double disc = host.emulator.plant().state().q[2];
  host.tick();
  EXPECT_NE(host.sensors.header.epoch, epoch);
  EXPECT_GE(host.sensors.header.epoch, 0);
  EXPECT_EQ(host.sensors.header.tick, 0);
  EXPECT_EQ(host.sensors.header.sim_time_ns, 0) << "its clock begins anew";
  EXPECT_NEAR(host.emulator.plant().state().q[2], disc, 0.01) << "nobody put it back";
  EXPECT_EQ(host.emulator.plant().tick(), 301);
  EXPECT_EQ(host.emulator.restarts(), 1);

  // HELD by itself, since nobody says anything: nobody props it up either.
  const model::State left = host.emulator.plant().state();
  const double tilt_deg = host.tilt_deg();
  host.run(0.02);
  ASSERT_EQ(host.emulator.device().mode, status_t::MODE_HELD);
  EXPECT_EQ(host.emulator.plant().input().drive[0], 0.0);
  const model::State& after = host.emulator.plant().state();
  // Put back, its disc would be where it began; it turned by -0.88 rad since.
  EXPECT_NEAR(after.q[2] - left.q[2], 0.02 * left.v[2], 0.005);  // measured 5e-5
  EXPECT_NE(after.v[0], left.v[0]);
  EXPECT_NE(host.tilt_deg(), tilt_deg);

  // Until the host says so.
  host.tick();  // the line is back
  host.say(status_t::MODE_HELD);
  host.tick();
  const model::State begin = host.rig.initial_state(host.emulator.plant().machine());
  EXPECT_EQ(host.emulator.plant().state().v[0], begin.v[0]);
  EXPECT_EQ(host.emulator.plant().state().q[0], begin.q[0]);
}

TEST(RigEmulator, WhatIsCausedNowBeginsWithTheNextSample) {
  Host host("prototype_b");
  host.run(0.1);
  host.emulator.cause(parse_trouble("restart", host.emulator.time_s()));
  host.emulator.cause(parse_trouble("estop+0.002", host.emulator.time_s()));
  host.tick();
  EXPECT_EQ(host.emulator.restarts(), 1);
  EXPECT_EQ(host.sensors.estop, 1);
  host.run(0.002);
  EXPECT_EQ(host.emulator.restarts(), 1) << "once";
  EXPECT_EQ(host.sensors.estop, 0);
}

/// Under way it may not go on as if nothing had been: the host must hold it first.
TEST(RigEmulator, ARestartedFirmwareWaitsForTheHostToHoldIt) {
  Host host("prototype_b");
  host.emulator.cause(parse_trouble("restart@0.3", 0.0));
  host.arm();
  host.run(0.4);
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_SAFE_STOP);
  EXPECT_EQ(host.emulator.device().stop, GYROTWIN_STOP_NOT_HELD);
  host.arm();
  EXPECT_EQ(host.emulator.device().mode, status_t::MODE_RUNNING);
}

TEST(RigEmulator, ARigWithoutSensorsIsRefused) {
  Rig rig = load_rig("prototype_b");
  rig.sensors.reset();
  EXPECT_THROW(Emulator(rig, 1, 0), Error);
}

TEST(RigEmulator, RotorsRunDownAndUpWhilePropped) {
  Host host("gyrocar");
  host.say(status_t::MODE_HELD);
  host.run(0.1);
  EXPECT_EQ(host.device.rotors, beat_t::ROTORS_ON) << "as at the start of a run";
  const double before = host.emulator.plant().state().rotor_speed[0];
  host.beat.rotors = beat_t::ROTORS_OFF;
  host.say(status_t::MODE_HELD);
  host.run(5.0);
  EXPECT_EQ(host.device.rotors, beat_t::ROTORS_OFF);
  const double slower = host.emulator.plant().state().rotor_speed[0];
  EXPECT_LT(std::abs(slower), std::abs(before));
  host.beat.rotors = beat_t::ROTORS_ON;
  host.say(status_t::MODE_HELD);
  host.run(5.0);
  EXPECT_GT(std::abs(host.emulator.plant().state().rotor_speed[0]), std::abs(slower));
}

TEST(RigEmulator, TheSameBytesMakeTheSameRig) {
  const auto last = [] {
    Host host("prototype_b");
    host.emulator.cause(parse_trouble("flips@0.1+1=0.001", 0.0));
    host.arm();
    host.run(1.0);
    return std::pair(encoded(host.sensors), host.unframer.bad());
  };
  EXPECT_EQ(last(), last());
}

}  // namespace
}  // namespace gyrotwin
