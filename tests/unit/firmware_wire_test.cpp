// The firmware's messages are LCM's, byte by byte, both ways.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "messages/channels.hpp"
#include "services/hardware/firmware/gyrotwin_frame.h"
#include "services/hardware/firmware/gyrotwin_wire.h"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

/// A pair of the same message, as LCM has it and as the firmware has it.
template <class Message, class Struct, std::uint64_t fingerprint,
          void (*encode_c)(const Struct*, std::uint8_t*),
          bool (*decode_c)(const std::uint8_t*, std::size_t, Struct*)>
struct Pair {
  using Lcm = Message;
  using C = Struct;
  static constexpr std::uint64_t kFingerprint = fingerprint;
  static std::vector<std::uint8_t> encode(const C& message) {
    std::vector<std::uint8_t> bytes(kWireSize<Lcm>, 0xaa);
    encode_c(&message, bytes.data());
    return bytes;
  }
  static bool decode(const std::vector<std::uint8_t>& bytes, C& message) {
    return decode_c(bytes.data(), bytes.size(), &message);
  }
};

using Pairs = ::testing::Types<Pair<sensors_t, gyrotwin_sensors, GYROTWIN_SENSORS_FINGERPRINT,
                                    gyrotwin_sensors_encode, gyrotwin_sensors_decode>,
                               Pair<beat_t, gyrotwin_beat, GYROTWIN_BEAT_FINGERPRINT,
                                    gyrotwin_beat_encode, gyrotwin_beat_decode>,
                               Pair<reply_t, gyrotwin_reply, GYROTWIN_REPLY_FINGERPRINT,
                                    gyrotwin_reply_encode, gyrotwin_reply_decode>,
                               Pair<command_t, gyrotwin_command, GYROTWIN_COMMAND_FINGERPRINT,
                                    gyrotwin_command_encode, gyrotwin_command_decode>,
                               Pair<request_t, gyrotwin_request, GYROTWIN_REQUEST_FINGERPRINT,
                                    gyrotwin_request_encode, gyrotwin_request_decode>>;

template <class Of>
class FirmwareWire : public ::testing::Test {};
TYPED_TEST_SUITE(FirmwareWire, Pairs);

/// Distinct fields; no signature, as on a line.
template <class Message>
Message unsigned_distinct() {
  Message message = distinct<Message>();
  std::memset(message.mac, 0, sizeof message.mac);
  return message;
}

TYPED_TEST(FirmwareWire, FingerprintIsThatOfLcmGen) {
  EXPECT_EQ(TypeParam::kFingerprint, static_cast<std::uint64_t>(TypeParam::Lcm::getHash()));
}

TYPED_TEST(FirmwareWire, WhatLcmEncodesComesOutAgain) {
  // The distinct message has another value in every field, so that no two can be swapped or lost.
  const auto bytes = encoded(unsigned_distinct<typename TypeParam::Lcm>());
  typename TypeParam::C message;
  ASSERT_TRUE(TypeParam::decode(bytes, message));
  EXPECT_EQ(TypeParam::encode(message), bytes);
}

TYPED_TEST(FirmwareWire, AnythingElseIsNotDecoded) {
  const auto bytes = encoded(unsigned_distinct<typename TypeParam::Lcm>());
  typename TypeParam::C message, before;
  std::memset(&message, 0x55, sizeof message);
  std::memcpy(&before, &message, sizeof message);
  auto shorter = bytes, longer = bytes;
  shorter.pop_back();
  longer.push_back(0);
  EXPECT_FALSE(TypeParam::decode(shorter, message));
  EXPECT_FALSE(TypeParam::decode(longer, message));
  EXPECT_FALSE(TypeParam::decode({}, message));
  for (std::size_t i = 0; i < 8; ++i) {
    auto other = bytes;
    other[i] ^= 0x10;
    EXPECT_FALSE(TypeParam::decode(other, message));
  }
  EXPECT_EQ(std::memcmp(&message, &before, sizeof message), 0);
}

/// Each field by its name, so that two fields that are both read and written in the wrong place are
/// seen too.
template <class A, class B>
void expect_header(const A& a, const B& b) {
  EXPECT_EQ(a.rig_id, b.rig_id);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.epoch, b.epoch);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.sim_time_ns, b.sim_time_ns);
  EXPECT_EQ(a.sender_mono_ns, b.sender_mono_ns);
}

template <class X, std::size_t N>
void expect_array(const X (&a)[N], const X (&b)[N]) {
  EXPECT_TRUE(std::equal(a, a + N, b));
}

TEST(FirmwareWireNames, Sensors) {
  const auto lcm = distinct<sensors_t>();
  gyrotwin_sensors c;
  const auto bytes = encoded(lcm);
  ASSERT_TRUE(gyrotwin_sensors_decode(bytes.data(), bytes.size(), &c));
  expect_header(c.header, lcm.header);
  EXPECT_EQ(c.valid, lcm.valid);
  EXPECT_EQ(c.estop, lcm.estop);
  expect_array(c.gyro_rad_s, lcm.gyro_rad_s);
  expect_array(c.acceleration_m_s2, lcm.acceleration_m_s2);
  EXPECT_EQ(c.disc_angle_rad, lcm.disc_angle_rad);
  expect_array(c.gimbal_angle_rad, lcm.gimbal_angle_rad);
  expect_array(c.rotor_speed_rad_s, lcm.rotor_speed_rad_s);
  expect_array(c.drive_current_a, lcm.drive_current_a);
  EXPECT_EQ(c.bus_voltage_v, lcm.bus_voltage_v);
  EXPECT_EQ(c.load_cell_n, lcm.load_cell_n);
}

TEST(FirmwareWireNames, Beat) {
  const auto lcm = distinct<beat_t>();
  gyrotwin_beat c;
  const auto bytes = encoded(lcm);
  ASSERT_TRUE(gyrotwin_beat_decode(bytes.data(), bytes.size(), &c));
  expect_header(c.header, lcm.header);
  EXPECT_EQ(c.mode, lcm.mode);
  EXPECT_EQ(c.rotors, lcm.rotors);
  EXPECT_EQ(c.command_timeout_ticks, lcm.command_timeout_ticks);
  EXPECT_EQ(c.safe_stop, lcm.safe_stop);
  EXPECT_EQ(c.safe_stop_gain, lcm.safe_stop_gain);
  EXPECT_EQ(c.sent_ns, lcm.sent_ns);
  EXPECT_EQ(c.echo_ns, lcm.echo_ns);
  EXPECT_EQ(c.heard_ns, lcm.heard_ns);
  EXPECT_EQ(c.frames_received, lcm.frames_received);
  EXPECT_EQ(c.frames_bad, lcm.frames_bad);
  EXPECT_EQ(c.frames_dropped, lcm.frames_dropped);
  EXPECT_EQ(c.commands_obeyed, lcm.commands_obeyed);
  EXPECT_EQ(c.safe_stops, lcm.safe_stops);
}

TEST(FirmwareWireNames, Command) {
  const auto lcm = distinct<command_t>();
  gyrotwin_command c;
  const auto bytes = encoded(lcm);
  ASSERT_TRUE(gyrotwin_command_decode(bytes.data(), bytes.size(), &c));
  expect_header(c.header, lcm.header);
  EXPECT_EQ(c.mode, lcm.mode);
  EXPECT_EQ(c.valid_ticks, lcm.valid_ticks);
  expect_array(c.value, lcm.value);
  EXPECT_EQ(c.for_tick, lcm.for_tick);
  EXPECT_EQ(c.owner_epoch, lcm.owner_epoch);
  EXPECT_EQ(c.writer, lcm.writer);
  EXPECT_EQ(c.counter, lcm.counter);
}

TEST(FirmwareWireNames, Reply) {
  const auto lcm = distinct<reply_t>();
  gyrotwin_reply c;
  const auto bytes = encoded(lcm);
  ASSERT_TRUE(gyrotwin_reply_decode(bytes.data(), bytes.size(), &c));
  expect_header(c.header, lcm.header);
  EXPECT_EQ(c.request_writer, lcm.request_writer);
  EXPECT_EQ(c.request_counter, lcm.request_counter);
  EXPECT_EQ(c.verb, lcm.verb);
  EXPECT_EQ(c.result, lcm.result);
  EXPECT_EQ(c.applied_tick, lcm.applied_tick);
  EXPECT_EQ(c.id, lcm.id);
  expect_array(c.text, lcm.text);
}

TEST(FirmwareWireNames, Request) {
  const auto lcm = distinct<request_t>();
  gyrotwin_request c;
  const auto bytes = encoded(lcm);
  ASSERT_TRUE(gyrotwin_request_decode(bytes.data(), bytes.size(), &c));
  expect_header(c.header, lcm.header);
  EXPECT_EQ(c.verb, lcm.verb);
  EXPECT_EQ(c.kind, lcm.kind);
  EXPECT_EQ(c.initial_given, lcm.initial_given);
  EXPECT_EQ(c.target, lcm.target);
  expect_array(c.initial_q, lcm.initial_q);
  expect_array(c.initial_v, lcm.initial_v);
  EXPECT_EQ(c.speed_factor, lcm.speed_factor);
  EXPECT_EQ(c.step_ticks, lcm.step_ticks);
  EXPECT_EQ(c.id, lcm.id);
  EXPECT_EQ(c.start_tick, lcm.start_tick);
  EXPECT_EQ(c.duration_ns, lcm.duration_ns);
  EXPECT_EQ(c.rise_ns, lcm.rise_ns);
  EXPECT_EQ(c.seed, lcm.seed);
  expect_array(c.force_n, lcm.force_n);
  expect_array(c.moment_nm, lcm.moment_nm);
  expect_array(c.frequency_hz, lcm.frequency_hz);
  EXPECT_EQ(c.speed_m_s, lcm.speed_m_s);
  EXPECT_EQ(c.direction_rad, lcm.direction_rad);
  EXPECT_EQ(c.turbulence_m_s, lcm.turbulence_m_s);
  EXPECT_EQ(c.length_m, lcm.length_m);
  EXPECT_EQ(c.correlation_s, lcm.correlation_s);
  EXPECT_EQ(c.yaw_rate_rad_s, lcm.yaw_rate_rad_s);
  EXPECT_EQ(c.deceleration_m_s2, lcm.deceleration_m_s2);
  EXPECT_EQ(c.mass_kg, lcm.mass_kg);
  expect_array(c.position_m, lcm.position_m);
  EXPECT_EQ(c.level, lcm.level);
  EXPECT_EQ(c.delay_ns, lcm.delay_ns);
  EXPECT_EQ(c.owner_epoch, lcm.owner_epoch);
  EXPECT_EQ(c.writer, lcm.writer);
  EXPECT_EQ(c.counter, lcm.counter);
}

// Constants and sizes are LCM's.
static_assert(GYROTWIN_SENSORS_SIZE == kWireSize<sensors_t>);
static_assert(GYROTWIN_BEAT_SIZE == kWireSize<beat_t>);
static_assert(GYROTWIN_REPLY_SIZE == kWireSize<reply_t>);
static_assert(GYROTWIN_COMMAND_SIZE == kWireSize<command_t>);
static_assert(GYROTWIN_REQUEST_SIZE == kWireSize<request_t>);
static_assert(GYROTWIN_PAYLOAD_MAX == kWireSize<request_t>, "the longest on the line");

#define SAME(mine, lcms) EXPECT_EQ(int{mine}, int{lcms})

TEST(FirmwareWireNames, ConstantsAreLcms) {
  SAME(GYROTWIN_HARDWARE, header_t::HARDWARE);
  SAME(GYROTWIN_HELD, status_t::MODE_HELD);
  SAME(GYROTWIN_RUNNING, status_t::MODE_RUNNING);
  SAME(GYROTWIN_PAUSED, status_t::MODE_PAUSED);
  SAME(GYROTWIN_SAFE_STOP, status_t::MODE_SAFE_STOP);
  SAME(GYROTWIN_FALLEN, status_t::MODE_FALLEN);
  SAME(GYROTWIN_FAULT, status_t::MODE_FAULT);
  SAME(GYROTWIN_ZERO_TORQUE, beat_t::ZERO_TORQUE);
  SAME(GYROTWIN_BRAKE, beat_t::BRAKE);
  SAME(GYROTWIN_HOLD_SPEED, beat_t::HOLD_SPEED);
  SAME(GYROTWIN_ROTORS_AS_THEY_ARE, beat_t::ROTORS_AS_THEY_ARE);
  SAME(GYROTWIN_ROTORS_ON, beat_t::ROTORS_ON);
  SAME(GYROTWIN_ROTORS_OFF, beat_t::ROTORS_OFF);
  SAME(GYROTWIN_TORQUE_NM, command_t::TORQUE_NM);
  SAME(GYROTWIN_VOLTAGE_V, command_t::VOLTAGE_V);
  SAME(GYROTWIN_APPLIED, reply_t::APPLIED);
  SAME(GYROTWIN_REFUSED, reply_t::REFUSED);
  SAME(GYROTWIN_VERB_DISTURB, request_t::DISTURB);
  SAME(GYROTWIN_VERB_CLEAR, request_t::CLEAR);
  SAME(GYROTWIN_VERB_CANCEL, request_t::CANCEL);
  SAME(GYROTWIN_VERB_FAULT, request_t::FAULT);
  SAME(GYROTWIN_VALID_GYRO, sensors_t::VALID_GYRO);
  SAME(GYROTWIN_VALID_ACCELEROMETER, sensors_t::VALID_ACCELEROMETER);
  SAME(GYROTWIN_VALID_DISC, sensors_t::VALID_DISC);
  SAME(GYROTWIN_VALID_GIMBALS, sensors_t::VALID_GIMBALS);
  SAME(GYROTWIN_VALID_ROTORS, sensors_t::VALID_ROTORS);
  SAME(GYROTWIN_VALID_CURRENTS, sensors_t::VALID_CURRENTS);
  SAME(GYROTWIN_VALID_BUS_VOLTAGE, sensors_t::VALID_BUS_VOLTAGE);
  SAME(GYROTWIN_VALID_LOAD_CELL, sensors_t::VALID_LOAD_CELL);
  SAME(GYROTWIN_VALID_ESTOP, sensors_t::VALID_ESTOP);
}

}  // namespace
}  // namespace gyrotwin
