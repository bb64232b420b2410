// Frames that wait for a line: in order, whole, the oldest dropped.
#include <gtest/gtest.h>

#include <random>

#include "services/hardware/firmware/gyrotwin_outbox.h"
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
