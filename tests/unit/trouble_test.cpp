// Troubles as they are written, the clock of a device, and damage on a line.
#include "clients/rig_emulator/trouble.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "clients/rig_emulator/device_clock.hpp"
#include "clients/rig_emulator/line_damage.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

using Kind = Trouble::Kind;

TEST(Trouble, IsReadAsItIsWritten) {
  const Trouble silent = parse_trouble("silent@5+0.5", 0.0);
  EXPECT_EQ(silent.kind, Kind::kSilent);
  EXPECT_EQ(silent.at_s, 5.0);
  EXPECT_EQ(silent.duration_s, 0.5);
  const Trouble flips = parse_trouble("flips@8+2=0.001", 0.0);
  EXPECT_EQ(flips.kind, Kind::kFlips);
  EXPECT_EQ(flips.share, 0.001);
  const Trouble restart = parse_trouble("restart", 12.5);
  EXPECT_EQ(restart.kind, Kind::kRestart);
  EXPECT_EQ(restart.at_s, 12.5) << "now";
  EXPECT_FALSE(restart.duration_s);
  EXPECT_EQ(parse_trouble("flips=1e-3", 0.0).share, 1e-3);
  EXPECT_EQ(parse_trouble("estop+1", 3.0).at_s, 3.0);
  for (const TroubleWord& word : trouble_words()) {
    const std::string text = std::string(word.name) + (word.kind == Kind::kFlips ? "=0.1" : "");
    EXPECT_EQ(parse_trouble(text, 0.0).kind, word.kind);
  }
}

TEST(Trouble, WhatMakesNoSenseIsRefusedByName) {
  for (const char* text : {"", "silence", "silent@", "silent@x", "silent@-1", "silent@nan",
                           "silent@inf", "silent@1e9", "silent@1+", "silent@1+2+3", "silent=0.1",
                           "flips", "flips=2", "flips=-0.1", "restart+1", "estop 1", "estop@1 "}) {
    EXPECT_THROW(parse_trouble(text, 0.0), Error) << text;
  }
  try {
    parse_trouble("silet@1", 0.0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("`silent`"), std::string::npos) << error.what();
  }
}

TEST(DeviceClock, HasAnotherZeroAndAnotherRate) {
  FakeClock host;
  host.advance(5'000'000'000);
  const DeviceClock clock(host, 3'000'000'000, 250.0);
  EXPECT_EQ(clock.now_ns(), 8'000'000'000);
  host.advance(1'000'000'000);
  EXPECT_EQ(clock.now_ns(), 9'000'250'000);
  // Two roundings to a nanosecond.
  EXPECT_NEAR(static_cast<double>(clock.to_host(9'000'250'000)), 6e9, 2.0);
  host.advance(86'400'000'000'000);
  EXPECT_NEAR(static_cast<double>(clock.to_host(clock.now_ns()) - host.now_ns()), 0.0, 2.0);
}

TEST(DeviceClock, MayRunSlow) {
  FakeClock host;
  const DeviceClock clock(host, -1'000, -1e5);
  host.advance(1'000'000);
  EXPECT_EQ(clock.now_ns(), 899'000);
  EXPECT_NEAR(static_cast<double>(clock.to_host(899'000)), 1e6, 2.0);
}

std::vector<std::uint8_t> passed(LineDamage& line, const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> arrived;
  line.pass(bytes, [&arrived](std::uint8_t byte) { arrived.push_back(byte); });
  return arrived;
}

TEST(LineDamage, AGoodLinePassesEverything) {
  LineDamage line(1);
  const std::vector<std::uint8_t> bytes{1, 2, 3, 0, 0, 4, 255, 0};
  EXPECT_EQ(passed(line, bytes), bytes);
}

TEST(LineDamage, HalvesTakeTheEndOfEveryFrame) {
  LineDamage line(1);
  line.halves = true;
  std::vector<std::uint8_t> frame(200, 7);
  frame.push_back(0);
  for (int k = 0; k < 100; ++k) {
    const auto arrived = passed(line, frame);
    EXPECT_GE(arrived.size(), 1u);
    EXPECT_LE(arrived.size(), 160u);
    EXPECT_EQ(arrived.back(), 7);
  }
}

TEST(LineDamage, FlipsHitTheShareOfBytesAndOneBitEach) {
  LineDamage line(1);
  line.flips = 0.1;
  const std::vector<std::uint8_t> bytes(100'000, 0x55);
  const auto arrived = passed(line, bytes);
  ASSERT_EQ(arrived.size(), bytes.size());
  int hit = 0;
  for (const std::uint8_t byte : arrived) {
    const int bits = __builtin_popcount(byte ^ 0x55u);
    ASSERT_LE(bits, 1);
    hit += bits;
  }
  EXPECT_NEAR(hit, 10'000, 400);  // four standard deviations
}

}  // namespace
}  // namespace gyrotwin
