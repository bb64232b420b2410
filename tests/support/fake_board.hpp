// A board for the firmware's device, and a host that speaks to it, for tests: time passes when told
// to, the line takes what it is told to.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "services/hardware/firmware/gyrotwin_device.h"
#include "tests/support/line_frames.hpp"

namespace gyrotwin {

/// What the board's functions see and do.
struct FakeBoard {
  std::int64_t now = 5'000'000'000;
  gyrotwin_sensors sensors{};
  gyrotwin_drives drives{};
  int drive_calls = 0;
  std::array<double, 4> speed{};
  bool rotors = false;
  int rotor_switches = 0;
  std::size_t line_takes = 1u << 20;  // bytes, from now on
  std::array<std::uint8_t, 1u << 16> line{};
  std::size_t line_size = 0;

  gyrotwin_board functions() {
    gyrotwin_board board{};
    board.context = this;
    board.now_ns = [](void* self) { return of(self).now; };
    board.read_sensors = [](void* self, gyrotwin_sensors* read) { *read = of(self).sensors; };
    board.drive = [](void* self, const gyrotwin_drives* asked) {
      of(self).drives = *asked;
      ++of(self).drive_calls;
    };
    board.drive_speed = [](void* self, int drive) {
      return of(self).speed[static_cast<std::size_t>(drive)];
    };
    board.power_rotors = [](void* self, bool on) {
      of(self).rotors = on;
      ++of(self).rotor_switches;
    };
    board.rotors_powered = [](void* self) { return of(self).rotors; };
    board.write = [](void* self, const std::uint8_t* bytes, std::size_t size) {
      return of(self).write(bytes, size);
    };
    return board;
  }

  std::size_t write(const std::uint8_t* bytes, std::size_t size) {
    const std::size_t taken = std::min({size, line_takes, line.size() - line_size});
    std::copy_n(bytes, taken, line.begin() + static_cast<std::ptrdiff_t>(line_size));
    line_size += taken;
    line_takes -= taken;
    return taken;
  }

  /// What has gone out since the last call.
  std::vector<FrameBytes> payloads() {
    const auto found = unframer.take(std::span(line).first(line_size));
    line_size = 0;
    return found;
  }

  static FakeBoard& of(void* self) { return *static_cast<FakeBoard*>(self); }

  Unframer unframer;
};

/// A device on a fake board, and the daemon at the other end.
class DeviceBench {
 public:
  static constexpr std::int32_t kRig = 7;
  static constexpr std::int64_t kOwner = 1234;      // its epoch
  static constexpr std::int64_t kTick = 1'000'000;  // [ns]
  static constexpr std::int64_t kDevice = 99;       // epoch

  DeviceBench() : functions(board.functions()) {
    gyrotwin_device_init(&device, &functions, kRig, kDevice);
    beat.header.rig_id = kRig;
    beat.header.source = header_t::HARDWARE;
    beat.header.epoch = kOwner;
    beat.command_timeout_ticks = 5;
    beat.safe_stop = beat_t::ZERO_TORQUE;
    command.header = beat.header;
    command.mode = command_t::TORQUE_NM;
    command.valid_ticks = 5;
    command.value[0] = 1.5;
    command.owner_epoch = kOwner;
  }
  DeviceBench(const DeviceBench&) = delete;
  DeviceBench& operator=(const DeviceBench&) = delete;

  void receive(const FrameBytes& bytes) {
    gyrotwin_device_receive(&device, bytes.data(), bytes.size());
  }
  void say(std::int32_t mode) {
    beat.mode = mode;
    beat.sent_ns = beat.echo_ns = board.now;
    receive(frame_of(beat));
  }
  /// Answers the newest sample.
  void send_command() {
    command.for_tick = std::max<std::int64_t>(0, device.samples - 1);
    receive(frame_of(command));
  }
  void send_command(double value) {
    command.value[0] = value;
    send_command();
  }
  /// Time passes, then a sample.
  void sample(int count = 1) {
    for (int i = 0; i < count; ++i) {
      board.now += kTick;
      gyrotwin_device_sample(&device);
    }
  }
  void run() {
    say(status_t::MODE_HELD);
    say(status_t::MODE_RUNNING);
  }
  /// Messages of this type that have gone out since the last look.
  template <class Message>
  std::vector<Message> sent() {
    std::vector<Message> found;
    for (const FrameBytes& payload : board.payloads()) {
      Message message;
      if (decode(payload, message)) found.push_back(message);
    }
    return found;
  }

  FakeBoard board;
  gyrotwin_board functions;
  gyrotwin_device device;
  beat_t beat{};
  command_t command{};
};

}  // namespace gyrotwin
