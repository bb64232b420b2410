// The rules of a device: when commands act, when it stops by itself, what it says.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "services/hardware/firmware/gyrotwin_device.h"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/fake_board.hpp"

namespace gyrotwin {
namespace {

constexpr std::int32_t kHeld = status_t::MODE_HELD, kRunning = status_t::MODE_RUNNING,
                       kSafeStop = status_t::MODE_SAFE_STOP;

TEST(FirmwareDevice, BeginsHeldWithDrivesOff) {
  const DeviceBench bench;
  EXPECT_EQ(bench.device.mode, kHeld);
  EXPECT_EQ(bench.board.drive_calls, 1);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_OFF);
}

TEST(FirmwareDevice, RunsWhenTheHostSaysSoAndCommandsActAtOnce) {
  DeviceBench bench;
  bench.send_command();  // nothing acts while HELD
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_OFF);
  bench.run();
  EXPECT_EQ(bench.device.mode, kRunning);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_TORQUE);
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  bench.command.value[3] = -4.0;
  bench.send_command(2.5);
  EXPECT_EQ(bench.board.drives.value[0], 2.5);
  EXPECT_EQ(bench.board.drives.value[3], -4.0);
  bench.command.mode = command_t::VOLTAGE_V;
  bench.send_command(12.0);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_VOLTAGE);
  EXPECT_EQ(bench.board.drives.value[0], 12.0);
  EXPECT_EQ(bench.device.commands_obeyed, 2);
}

TEST(FirmwareDevice, ACommandActsForItsValidTicks) {
  for (int valid = 1; valid <= 4; ++valid) {
    DeviceBench bench;
    bench.run();
    bench.sample(3);
    bench.command.valid_ticks = valid;
    bench.send_command(1.5);
    EXPECT_EQ(bench.board.drives.value[0], 1.5) << "in the tick of the sample that it answers,";
    for (int k = 1; k < valid; ++k) {
      bench.sample();
      EXPECT_EQ(bench.board.drives.value[0], 1.5) << "and in each after it: " << valid << " " << k;
    }
    bench.sample();
    EXPECT_EQ(bench.board.drives.value[0], 0.0) << valid;
    EXPECT_EQ(bench.device.mode, kRunning);
  }
}

TEST(FirmwareDevice, ACommandsAgeCountsFromTheSampleThatItAnswers) {
  DeviceBench bench;
  bench.beat.command_timeout_ticks = 10;
  bench.run();
  bench.sample(6);  // the newest is 5
  bench.command.valid_ticks = 4;
  const auto send_for = [&](std::int64_t tick) {
    bench.command.for_tick = tick;
    bench.receive(frame_of(bench.command));
  };
  for (const std::int64_t tick :
       {std::int64_t{1}, std::int64_t{0}, std::int64_t{7}, std::int64_t{-1},
        std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    const std::int64_t refused = bench.device.commands_refused;
    send_for(tick);
    EXPECT_EQ(bench.device.commands_refused, refused + 1) << tick;
    EXPECT_EQ(bench.board.drives.value[0], 0.0) << tick;
  }
  EXPECT_EQ(bench.device.commands_obeyed, 0);

  // Three of its four ticks went by on the way, or two.
  send_for(2);
  EXPECT_EQ(bench.board.drives.value[0], 1.5);
  bench.sample();
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  send_for(4);
  bench.sample();
  EXPECT_EQ(bench.board.drives.value[0], 1.5);
  bench.sample();
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  EXPECT_EQ(bench.device.commands_obeyed, 2);
}

TEST(FirmwareDevice, CommandsThatCannotBeMeantAreRefused) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  DeviceBench bench;
  bench.run();
  bench.send_command(1.5);
  int refused = 0;
  const auto expect_refused = [&](const command_t& command) {
    bench.receive(frame_of(command));
    EXPECT_EQ(bench.device.commands_refused, ++refused);
    EXPECT_EQ(bench.board.drives.value[0], 1.5) << "what acts goes on";
  };
  for (const double bad : {kInf, -kInf, kNan}) {
    for (std::size_t i = 0; i < 4; ++i) {
      command_t command = bench.command;
      command.value[i] = bad;
      expect_refused(command);
    }
  }
  for (const std::int32_t mode : {0, 3, -1, std::numeric_limits<std::int32_t>::max()}) {
    command_t command = bench.command;
    command.mode = mode;
    expect_refused(command);
  }
  for (const std::int32_t valid : {0, -1, std::numeric_limits<std::int32_t>::min()}) {
    command_t command = bench.command;
    command.valid_ticks = valid;
    expect_refused(command);
  }
  command_t command = bench.command;
  command.owner_epoch = DeviceBench::kOwner + 1;
  expect_refused(command);
  EXPECT_EQ(bench.device.commands_obeyed, 1);
  // They do not count as commands either.
  bench.sample(5);
  EXPECT_EQ(bench.device.mode, kRunning);
  bench.receive(frame_of(command));
  bench.sample();
  EXPECT_EQ(bench.device.mode, kSafeStop);
}

TEST(FirmwareDevice, StopsAtExactlyTheTimeoutsSample) {
  for (int timeout = 1; timeout <= GYROTWIN_COMMAND_TIMEOUT_MAX; ++timeout) {
    DeviceBench bench;
    bench.beat.command_timeout_ticks = timeout;
    bench.command.valid_ticks = 100;
    bench.run();
    // The count begins with RUNNING,
    bench.sample(timeout);
    ASSERT_EQ(bench.device.mode, kRunning) << timeout;
    // and with each command.
    bench.send_command(1.5);
    bench.sample(timeout);
    ASSERT_EQ(bench.device.mode, kRunning) << timeout;
    ASSERT_EQ(bench.board.drives.value[0], 1.5);
    bench.sample();
    EXPECT_EQ(bench.device.mode, kSafeStop) << timeout;
    EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_COMMANDS);
    EXPECT_EQ(bench.board.drives.value[0], 0.0);
    EXPECT_EQ(bench.device.safe_stops, 1);
  }
}

TEST(FirmwareDevice, ASafeStopIsLatchedUntilTheHostSaysHeld) {
  DeviceBench bench;
  bench.run();
  bench.sample(6);
  ASSERT_EQ(bench.device.mode, kSafeStop);
  for (int k = 0; k < 20; ++k) {
    bench.say(kRunning);
    bench.send_command(1.5);
    bench.sample();
    ASSERT_EQ(bench.device.mode, kSafeStop);
    ASSERT_EQ(bench.board.drives.value[0], 0.0);
  }
  EXPECT_EQ(bench.device.safe_stops, 1);
  EXPECT_EQ(bench.device.commands_obeyed, 0);
  bench.say(kHeld);
  EXPECT_EQ(bench.device.mode, kHeld);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_OFF);
  bench.say(kRunning);
  bench.send_command(1.5);
  EXPECT_EQ(bench.device.mode, kRunning);
  EXPECT_EQ(bench.board.drives.value[0], 1.5);
}

TEST(FirmwareDevice, SilenceOfTheHostStopsItThoughCommandsCome) {
  DeviceBench bench;
  bench.run();
  for (int k = 0; k < 100; ++k) {
    bench.send_command(1.5);
    bench.sample();
    ASSERT_EQ(bench.device.mode, kRunning) << k;
  }
  bench.send_command(1.5);
  bench.sample();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_SILENCE);
  EXPECT_EQ(bench.device.safe_stops, 1);
}

/// Beats and commands come every tick; each beat echoes what the device sent `behind` ticks ago.
void run_behind(DeviceBench& bench, int ticks, std::int64_t behind) {
  for (int k = 0; k < ticks; ++k) {
    bench.beat.echo_ns = bench.board.now - behind * DeviceBench::kTick;
    bench.receive(frame_of(bench.beat));
    bench.send_command(1.5);
    bench.sample();
  }
}

TEST(FirmwareDevice, AHostThatIsFarBehindIsASilentOne) {
  DeviceBench bench;
  bench.sample(250);
  bench.run();
  run_behind(bench, 100, 199);  // 200 at the sample
  ASSERT_EQ(bench.device.mode, kRunning);
  run_behind(bench, 1, 200);
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_SILENCE);
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  EXPECT_EQ(bench.device.safe_stops, 1);
}

TEST(FirmwareDevice, TheFirstBeatsOfADeviceNeedTheirTimeToBeEchoed) {
  DeviceBench bench;
  bench.run();
  run_behind(bench, 201, 5000);
  EXPECT_EQ(bench.device.mode, kRunning) << "the first one was sent 200 ms ago";
  run_behind(bench, 1, 5000);
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_SILENCE);
}

TEST(FirmwareDevice, EveryOtherModeOfTheHostIsASafeStop) {
  constexpr std::array<std::int32_t, 4> kOthers{status_t::MODE_SAFE_STOP, status_t::MODE_FALLEN,
                                                status_t::MODE_FAULT, status_t::MODE_PAUSED};
  for (const std::int32_t mode : kOthers) {
    DeviceBench bench;
    bench.run();
    bench.send_command(1.5);
    bench.say(mode);
    EXPECT_EQ(bench.device.mode, kSafeStop);
    EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_HOST);
    EXPECT_EQ(bench.board.drives.value[0], 0.0);
    EXPECT_EQ(bench.device.safe_stops, 0) << "not by itself";
  }
}

TEST(FirmwareDevice, DrivesDoInASafeStopWhatTheBeatSaid) {
  DeviceBench bench;
  bench.beat.safe_stop = beat_t::BRAKE;
  bench.beat.safe_stop_gain = 0.25;
  bench.run();
  bench.sample(6);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_BRAKE);
  EXPECT_EQ(bench.board.drives.value[0], 0.25);
  EXPECT_EQ(bench.board.drives.value[3], 0.25);
}

TEST(FirmwareDevice, HoldsTheSpeedsOfTheStop) {
  DeviceBench bench;
  bench.beat.safe_stop = beat_t::HOLD_SPEED;
  bench.beat.safe_stop_gain = 2.0;
  bench.run();
  bench.sample(5);
  bench.board.speed = {-5.0, 1.0, 0.0, 0.0};
  bench.sample();
  ASSERT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.board.drives.mode, GYROTWIN_DRIVES_TORQUE);
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  bench.board.speed = {-4.5, 1.5, 0.0, std::numeric_limits<double>::quiet_NaN()};
  bench.sample();
  EXPECT_EQ(bench.board.drives.value[0], -1.0);
  EXPECT_EQ(bench.board.drives.value[1], -1.0);
  EXPECT_EQ(bench.board.drives.value[3], 0.0) << "what cannot be measured is not driven";
}

TEST(FirmwareDevice, EstopStopsAtOnceAndMayNotBeArmedAgainst) {
  DeviceBench bench;
  bench.board.sensors.valid = GYROTWIN_VALID_ESTOP;
  bench.run();
  bench.send_command(1.5);
  bench.sample();
  ASSERT_EQ(bench.device.mode, kRunning);
  bench.board.sensors.estop = 1;
  bench.sample();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_ESTOP);
  EXPECT_EQ(bench.board.drives.value[0], 0.0);
  EXPECT_EQ(bench.sent<sensors_t>().back().estop, 1);

  // Releasing is not enough, and saying HELD with it pressed leads nowhere.
  bench.board.sensors.estop = 0;
  bench.say(kRunning);
  bench.sample();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  bench.board.sensors.estop = 1;
  bench.sample();
  bench.run();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.safe_stops, 2);
  bench.board.sensors.estop = 0;
  bench.sample();
  bench.run();
  EXPECT_EQ(bench.device.mode, kRunning);
}

TEST(FirmwareDevice, ARigWithoutEstopHasNoneToPress) {
  DeviceBench bench;
  bench.board.sensors.estop = 1;
  bench.run();
  bench.sample();
  EXPECT_EQ(bench.device.mode, kRunning);
}

TEST(FirmwareDevice, AnEstopThatIsNotReadAnyMoreIsPressed) {
  DeviceBench bench;
  bench.board.sensors.valid = GYROTWIN_VALID_ESTOP;
  bench.sample();
  bench.run();
  bench.sample();
  ASSERT_EQ(bench.device.mode, kRunning);
  bench.board.sensors.valid = 0;
  bench.sample();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_ESTOP);
  bench.run();
  EXPECT_EQ(bench.device.mode, kSafeStop);
  bench.board.sensors.valid = GYROTWIN_VALID_ESTOP;
  bench.sample();
  bench.run();
  EXPECT_EQ(bench.device.mode, kRunning);
}

TEST(FirmwareDevice, RestartedUnderWayItDoesNotGoOn) {
  DeviceBench bench;
  bench.say(kRunning);
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_NOT_HELD);
  bench.run();
  EXPECT_EQ(bench.device.mode, kRunning);
}

TEST(FirmwareDevice, AnotherRunOfTheOwnerStopsIt) {
  DeviceBench bench;
  bench.run();
  ++bench.beat.header.epoch;
  bench.say(kRunning);
  EXPECT_EQ(bench.device.mode, kSafeStop);
  EXPECT_EQ(bench.device.stop, GYROTWIN_STOP_OTHER_RUN);
}

TEST(FirmwareDevice, FollowsOnlyBeatsThatMakeSense) {
  DeviceBench bench;
  std::int64_t bad = 0;
  const auto expect_refused = [&](const char* what, auto&& change) {
    beat_t beat = bench.beat;
    beat.mode = kHeld;
    change(beat);
    bench.receive(frame_of(beat));
    EXPECT_EQ(bench.device.frames_refused, ++bad) << what;
  };
  expect_refused("rig", [](beat_t& beat) { ++beat.header.rig_id; });
  expect_refused("its own", [](beat_t& beat) { beat.header.epoch = DeviceBench::kDevice; });
  expect_refused("mode", [](beat_t& beat) { beat.mode = 6; });
  expect_refused("mode", [](beat_t& beat) { beat.mode = -1; });
  expect_refused("rotors", [](beat_t& beat) { beat.rotors = 3; });
  expect_refused("timeout", [](beat_t& beat) { beat.command_timeout_ticks = 0; });
  expect_refused("timeout", [](beat_t& beat) { beat.command_timeout_ticks = 11; });
  expect_refused("safe stop", [](beat_t& beat) { beat.safe_stop = 0; });
  expect_refused("safe stop", [](beat_t& beat) { beat.safe_stop = 4; });
  expect_refused("gain", [](beat_t& beat) { beat.safe_stop_gain = -1.0; });
  expect_refused("gain", [](beat_t& beat) { beat.safe_stop_gain = HUGE_VAL; });
  bench.receive(frame_of(distinct<sensors_t>()));
  EXPECT_EQ(bench.device.frames_refused, ++bad);
  bench.receive(frame_of(distinct<state_t>()));
  EXPECT_EQ(bench.device.frames_refused, ++bad);
  EXPECT_FALSE(bench.device.was_held);
}

TEST(FirmwareDevice, SwitchesRotorsWhenAskedTo) {
  DeviceBench bench;
  bench.say(kHeld);
  EXPECT_EQ(bench.board.rotor_switches, 0) << "as they are";
  bench.beat.rotors = beat_t::ROTORS_ON;
  bench.say(kHeld);
  bench.say(kRunning);
  EXPECT_TRUE(bench.board.rotors);
  EXPECT_EQ(bench.board.rotor_switches, 1);
  bench.sample(10);
  EXPECT_EQ(bench.sent<beat_t>().back().rotors, beat_t::ROTORS_ON);
  bench.beat.rotors = beat_t::ROTORS_OFF;
  bench.say(kRunning);
  EXPECT_FALSE(bench.board.rotors);
}

TEST(FirmwareDevice, RotorsThatTheBoardHasCutAreNotSwitchedOnByEveryBeat) {
  DeviceBench bench;
  bench.beat.rotors = beat_t::ROTORS_ON;
  bench.say(kHeld);
  ASSERT_TRUE(bench.board.rotors);
  bench.board.rotors = false;  // by itself
  bench.say(kHeld);
  bench.say(kRunning);
  EXPECT_FALSE(bench.board.rotors);
  bench.beat.rotors = beat_t::ROTORS_AS_THEY_ARE;
  bench.say(kHeld);
  bench.beat.rotors = beat_t::ROTORS_ON;
  bench.say(kHeld);
  EXPECT_TRUE(bench.board.rotors) << "asked anew";
}

TEST(FirmwareDevice, RotorsAreNotSwitchedOnWhileTheEstopIsPressed) {
  DeviceBench bench;
  bench.board.sensors.valid = GYROTWIN_VALID_ESTOP;
  bench.board.sensors.estop = 1;
  bench.sample();
  bench.beat.rotors = beat_t::ROTORS_ON;
  bench.say(kHeld);
  EXPECT_FALSE(bench.board.rotors);
  bench.board.sensors.estop = 0;
  bench.sample();
  bench.say(kHeld);
  EXPECT_FALSE(bench.board.rotors) << "released, it is asked for anew or not at all";
  bench.beat.rotors = beat_t::ROTORS_OFF;
  bench.say(kHeld);
  bench.beat.rotors = beat_t::ROTORS_ON;
  bench.say(kHeld);
  ASSERT_TRUE(bench.board.rotors);

  // Pressing cuts nothing by itself; OFF acts nevertheless.
  bench.board.sensors.estop = 1;
  bench.sample(3);
  bench.say(kHeld);
  EXPECT_TRUE(bench.board.rotors);
  bench.beat.rotors = beat_t::ROTORS_OFF;
  bench.say(kHeld);
  EXPECT_FALSE(bench.board.rotors);
}

TEST(FirmwareDevice, SamplesCarryItsTickItsClockAndWhatTheBoardMeasured) {
  DeviceBench bench;
  bench.board.sensors.valid = GYROTWIN_VALID_GYRO | GYROTWIN_VALID_DISC;
  bench.board.sensors.gyro_rad_s[2] = 0.75;
  bench.board.sensors.disc_angle_rad = -3.5;
  bench.sample(25);
  const auto sent = bench.sent<sensors_t>();
  ASSERT_EQ(sent.size(), 25u);
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const header_t& header = sent[k].header;
    EXPECT_EQ(header.rig_id, DeviceBench::kRig);
    EXPECT_EQ(header.source, header_t::HARDWARE);
    EXPECT_EQ(header.epoch, DeviceBench::kDevice);
    EXPECT_EQ(header.tick, static_cast<std::int64_t>(k));
    EXPECT_EQ(header.sequence, header.tick);
    EXPECT_EQ(header.sim_time_ns, 5'000'000'000 + (header.tick + 1) * DeviceBench::kTick);
    EXPECT_EQ(sent[k].gyro_rad_s[2], 0.75);
    EXPECT_EQ(sent[k].disc_angle_rad, -3.5);
    EXPECT_EQ(sent[k].valid, GYROTWIN_VALID_GYRO | GYROTWIN_VALID_DISC);
  }
}

TEST(FirmwareDevice, BeatsTellTheTimesOfARoundTrip) {
  DeviceBench bench;
  bench.sample(10);
  const auto first = bench.sent<beat_t>();
  ASSERT_EQ(first.size(), 2u) << "with the first sample, then 100 a second";
  EXPECT_EQ(first[1].echo_ns, 0) << "nothing heard yet";

  bench.beat.safe_stop = beat_t::BRAKE;
  bench.beat.safe_stop_gain = 0.5;
  bench.beat.mode = kHeld;
  bench.beat.sent_ns = 123'456;
  bench.receive(frame_of(bench.beat));
  const std::int64_t heard = bench.board.now;
  bench.receive({1, 2, 3, 0});
  bench.sample(10);
  const auto second = bench.sent<beat_t>();
  ASSERT_EQ(second.size(), 1u);
  const beat_t& beat = second[0];
  EXPECT_EQ(beat.header.source, header_t::HARDWARE);
  EXPECT_EQ(beat.header.epoch, DeviceBench::kDevice);
  EXPECT_EQ(beat.mode, kHeld);
  EXPECT_EQ(beat.command_timeout_ticks, 5);
  EXPECT_EQ(beat.safe_stop, beat_t::BRAKE);
  EXPECT_EQ(beat.safe_stop_gain, 0.5);
  EXPECT_EQ(beat.echo_ns, 123'456);
  EXPECT_EQ(beat.heard_ns, heard);
  EXPECT_EQ(beat.sent_ns - first[1].sent_ns, 10 * DeviceBench::kTick);
  EXPECT_EQ(beat.frames_received, 1);
  EXPECT_EQ(beat.frames_bad, 1);
  EXPECT_EQ(beat.frames_dropped, 0);
}

TEST(FirmwareDevice, BeatsDoNotRaceAfterAPause) {
  DeviceBench bench;
  bench.sample(10);
  bench.sent<beat_t>();
  bench.board.now += 1'000'000'000;
  bench.sample(10);
  EXPECT_LE(bench.sent<beat_t>().size(), 2u);
}

request_t request_of(std::int32_t verb) {
  request_t request{};
  request.header.rig_id = DeviceBench::kRig;
  request.verb = verb;
  request.kind = request_t::LOAD;
  request.writer = 31;
  request.counter = 32;
  return request;
}

TEST(FirmwareDevice, ARealPlantCannotBeDisturbedByAsking) {
  DeviceBench bench;
  for (std::int32_t verb = request_t::ARM; verb <= request_t::FAULT; ++verb) {
    bench.receive(frame_of(request_of(verb)));
    const auto replies = bench.sent<reply_t>();
    ASSERT_EQ(replies.size(), 1u);
    EXPECT_EQ(replies[0].result, reply_t::REFUSED);
    EXPECT_EQ(replies[0].verb, verb);
    EXPECT_EQ(replies[0].request_writer, 31);
    EXPECT_EQ(replies[0].request_counter, 32);
    EXPECT_NE(replies[0].text[0], 0);
    EXPECT_EQ(bench.device.mode, kHeld);
  }
}

TEST(FirmwareDevice, ABoardThatCanBeDisturbedAnswersItself) {
  DeviceBench bench;
  static gyrotwin_request seen;
  bench.functions.request = [](void*, const gyrotwin_request* request, gyrotwin_reply* reply) {
    seen = *request;
    reply->result = GYROTWIN_APPLIED;
    reply->id = 4;
    reply->applied_tick = 17;
  };
  request_t request = request_of(request_t::DISTURB);
  request.moment_nm[1] = 0.5;
  bench.receive(frame_of(request));
  EXPECT_EQ(seen.moment_nm[1], 0.5);
  const auto replies = bench.sent<reply_t>();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].result, reply_t::APPLIED);
  EXPECT_EQ(replies[0].id, 4);
  EXPECT_EQ(replies[0].applied_tick, 17);
  bench.receive(frame_of(request_of(request_t::ARM)));
  EXPECT_EQ(bench.sent<reply_t>()[0].result, reply_t::REFUSED) << "arming is the owner's";
}

TEST(FirmwareDevice, ALineThatTakesNothingCostsOldFramesAndNothingElse) {
  DeviceBench bench;
  bench.sample(3);
  bench.sent<sensors_t>();
  // It stops in the middle of a frame, for 50 samples.
  bench.board.line_takes = 100;
  bench.sample(50);
  EXPECT_EQ(bench.sent<sensors_t>().size(), 0u);
  EXPECT_EQ(bench.device.samples, 53);
  // The one that was begun is finished, then come the newest; damage is none.
  bench.board.line_takes = 1u << 20;
  gyrotwin_device_flush(&bench.device);
  const auto payloads = bench.board.payloads();
  ASSERT_EQ(payloads.size(), static_cast<std::size_t>(GYROTWIN_OUTBOX_FRAMES));
  EXPECT_EQ(bench.board.unframer.bad(), 0);
  sensors_t first, last;
  ASSERT_TRUE(decode(payloads.front(), first));
  ASSERT_TRUE(decode(payloads.back(), last));
  EXPECT_EQ(first.header.tick, 3);
  EXPECT_EQ(last.header.tick, 52);
  // 50 samples and 5 beats, less those that came through.
  EXPECT_EQ(bench.device.outbox.dropped, 55 - GYROTWIN_OUTBOX_FRAMES);
}

TEST(FirmwareDevice, BytesMayComeInAnyPieces) {
  DeviceBench bench;
  bench.say(kHeld);
  bench.beat.mode = kRunning;
  FrameBytes bytes = frame_of(bench.beat);
  const FrameBytes command = frame_of(bench.command);
  bytes.insert(bytes.end(), command.begin(), command.end());
  for (const std::uint8_t byte : bytes) bench.receive({byte});
  EXPECT_EQ(bench.device.mode, kRunning);
  EXPECT_EQ(bench.board.drives.value[0], 1.5);
}

TEST(FirmwareDevice, AllocatesNothing) {
  DeviceBench bench;
  bench.beat.mode = kHeld;
  const FrameBytes held = frame_of(bench.beat);
  bench.beat.mode = kRunning;
  const FrameBytes running = frame_of(bench.beat);
  const FrameBytes command = frame_of(bench.command);
  const FrameBytes request = frame_of(request_of(request_t::DISTURB));
  const AllocationCounter allocations;
  for (int k = 0; k < 100; ++k) {
    for (const FrameBytes* frame : {&held, &running, &command, &request}) bench.receive(*frame);
    bench.sample(7);  // into a safe stop
    bench.board.line_size = 0;
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(bench.device.safe_stops, 100);
}

}  // namespace
}  // namespace gyrotwin
