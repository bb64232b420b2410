// Frames that wait for a line: in order, whole, the oldest dropped.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <random>

#include "services/hardware/firmware/gyrotwin_outbox.h"
#include "services/runtime/descriptor.hpp"
#include "tests/support/line_frames.hpp"

namespace gyrotwin {
namespace {

/// A line that takes a random number of bytes at a time.
struct Line {
  std::mt19937_64 random{1};
  FrameBytes bytes;

  static std::size_t write(void* self, const std::uint8_t* bytes, std::size_t size) {
    Line& line = *static_cast<Line*>(self);
    const auto taken =
        std::min(size, std::uniform_int_distribution<std::size_t>(0, 300)(line.random));
    line.bytes.insert(line.bytes.end(), bytes, bytes + taken);
    return taken;
  }
};

TEST(FirmwareOutbox, WhatComesOutIsWholeAndInOrder) {
  gyrotwin_outbox outbox;
  gyrotwin_outbox_init(&outbox);
  Line line;
  constexpr int kFrames = 20000;
  std::bernoulli_distribution flush(0.6);
  for (std::int32_t i = 0; i < kFrames; ++i) {
    FrameBytes payload(16, static_cast<std::uint8_t>(i));
    for (int b = 0; b < 4; ++b)
      payload[static_cast<std::size_t>(b)] = static_cast<std::uint8_t>(i >> (8 * b));
    payload.resize(100 + static_cast<std::size_t>(i % 180), 3);
    gyrotwin_outbox_add(&outbox, payload.data(), payload.size());
    ASSERT_LE(outbox.count, GYROTWIN_OUTBOX_FRAMES);
    if (flush(line.random)) gyrotwin_outbox_flush(&outbox, &Line::write, &line);
  }
  while (outbox.count > 0) gyrotwin_outbox_flush(&outbox, &Line::write, &line);

  Unframer unframer;
  const auto payloads = unframer.take(line.bytes);
  EXPECT_EQ(unframer.bad(), 0);
  std::int32_t last = -1;
  for (const FrameBytes& payload : payloads) {
    const std::int32_t i = payload[0] | payload[1] << 8 | payload[2] << 16;
    ASSERT_GT(i, last);
    last = i;
  }
  EXPECT_EQ(last, kFrames - 1) << "the newest is never the one that is dropped";
  EXPECT_EQ(static_cast<std::int64_t>(payloads.size()) + outbox.dropped, kFrames);
  EXPECT_GT(outbox.dropped, 0);
}

/// A pseudo-terminal whose reader takes a few bytes at a time, less than what comes.
TEST(FirmwareOutbox, ASlowReaderLosesTheOldestFrames) {
  const Descriptor device(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_TRUE(::grantpt(device.get()) == 0 && ::unlockpt(device.get()) == 0);
  const Descriptor host(::open(::ptsname(device.get()), O_RDWR | O_NOCTTY | O_NONBLOCK));
  termios settings{};
  ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
  ::cfmakeraw(&settings);
  ASSERT_EQ(::tcsetattr(host.get(), TCSANOW, &settings), 0);
  int terminal = device.get();
  const auto write = [](void* self, const std::uint8_t* bytes, std::size_t size) {
    const ssize_t count = ::write(*static_cast<int*>(self), bytes, size);
    return count > 0 ? static_cast<std::size_t>(count) : std::size_t{0};
  };

  gyrotwin_outbox outbox;
  gyrotwin_outbox_init(&outbox);
  Unframer unframer;
  std::vector<FrameBytes> payloads;
  const auto read = [&](std::size_t most) {
    std::array<std::uint8_t, 4096> bytes;
    const ssize_t count = ::read(host.get(), bytes.data(), most);
    if (count <= 0) return false;
    const auto whole = unframer.take(std::span(bytes).first(static_cast<std::size_t>(count)));
    payloads.insert(payloads.end(), whole.begin(), whole.end());
    return true;
  };
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) {
    FrameBytes payload(GYROTWIN_SENSORS_SIZE, 3);
    payload[0] = static_cast<std::uint8_t>(i);
    payload[1] = static_cast<std::uint8_t>(i >> 8);
    gyrotwin_outbox_add(&outbox, payload.data(), payload.size());
    gyrotwin_outbox_flush(&outbox, write, &terminal);
    read(7);
  }
  EXPECT_GT(outbox.dropped, 0);
  // The reader is awake again.
  for (int quiet = 0; outbox.count > 0 || quiet < 3;) {
    gyrotwin_outbox_flush(&outbox, write, &terminal);
    pollfd wait{.fd = host.get(), .events = POLLIN, .revents = 0};
    quiet = ::poll(&wait, 1, 100) > 0 && read(4096) ? 0 : quiet + 1;
  }
  EXPECT_EQ(unframer.bad(), 0);
  EXPECT_EQ(static_cast<std::int64_t>(payloads.size()) + outbox.dropped, kFrames);
  int last = -1;
  for (const FrameBytes& payload : payloads) {
    const int i = payload[0] | payload[1] << 8;
    ASSERT_GT(i, last);
    last = i;
  }
  EXPECT_EQ(last, kFrames - 1);
}

TEST(FirmwareOutbox, AFrameLongerThanAnyIsDroppedItself) {
  gyrotwin_outbox outbox;
  gyrotwin_outbox_init(&outbox);
  const FrameBytes payload(GYROTWIN_REQUEST_SIZE, 1);
  gyrotwin_outbox_add(&outbox, payload.data(), payload.size());
  EXPECT_EQ(outbox.count, 0);
  EXPECT_EQ(outbox.dropped, 1);
}

}  // namespace
}  // namespace gyrotwin
