// The framing of the line: what goes in comes out, and nothing else ever does.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>

#include "services/hardware/firmware/gyrotwin_frame.h"
#include "tests/support/line_frames.hpp"

namespace gyrotwin {
namespace {

using Random = std::mt19937_64;

/// IEEE 802.3, bit by bit.
std::uint32_t reference_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// COBS as its paper has it: what stands between two zeros (one is imagined at the end), in blocks.
FrameBytes reference_cobs(FrameBytes bytes) {
  FrameBytes stuffed;
  bytes.push_back(0);
  for (auto begin = bytes.begin(); begin != bytes.end();) {
    const auto zero = std::find(begin, bytes.end(), 0);
    const auto length = std::min<std::ptrdiff_t>(zero - begin, 254);
    stuffed.push_back(static_cast<std::uint8_t>(length + 1));
    stuffed.insert(stuffed.end(), begin, begin + length);
    begin += length;
    if (length < 254) {
      ++begin;  // the zero
    } else if (begin + 1 == bytes.end()) {
      break;  // the imagined zero needs no block of its own
    }
  }
  return stuffed;
}

FrameBytes reference_frame(FrameBytes payload) {
  const std::uint32_t crc = reference_crc(payload);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    payload.push_back(static_cast<std::uint8_t>(crc >> shift));
  }
  FrameBytes frame = reference_cobs(payload);
  frame.push_back(0);
  return frame;
}

/// With zeros in this share of the places.
FrameBytes random_payload(Random& random, std::size_t size, double zeros) {
  FrameBytes payload(size);
  std::bernoulli_distribution zero(zeros);
  std::uniform_int_distribution<int> byte(1, 255);
  for (auto& b : payload) b = static_cast<std::uint8_t>(zero(random) ? 0 : byte(random));
  return payload;
}

FrameBytes operator+(FrameBytes a, const FrameBytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void expect_round_trip(const FrameBytes& payload) {
  const FrameBytes frame = framed(payload);
  ASSERT_EQ(frame, reference_frame(payload)) << payload.size() << " bytes";
  ASSERT_LE(frame.size(), static_cast<std::size_t>(GYROTWIN_FRAME_SIZE(payload.size())));
  ASSERT_EQ(std::count(frame.begin(), frame.end(), 0), 1) << "the one at its end";
  Unframer unframer;
  const auto payloads = unframer.take(frame);
  ASSERT_EQ(payloads.size(), 1u);
  ASSERT_EQ(payloads[0], payload);
  ASSERT_EQ(unframer.bad(), 0);
}

TEST(FirmwareCrc, OfTheCheckStringIsTheCheckValue) {
  const std::string_view check = "123456789";
  EXPECT_EQ(gyrotwin_crc32(reinterpret_cast<const std::uint8_t*>(check.data()), check.size()),
            0xcbf43926u);
  EXPECT_EQ(gyrotwin_crc32(nullptr, 0), 0u);
}

TEST(FirmwareFrame, EveryLengthWithNoZerosOnlyZerosAndSome) {
  Random random(1);
  for (std::size_t size = 1; size <= GYROTWIN_PAYLOAD_MAX; ++size) {
    expect_round_trip(random_payload(random, size, 0.0));
    expect_round_trip(FrameBytes(size, 0));
    expect_round_trip(random_payload(random, size, 0.01));
    expect_round_trip(random_payload(random, size, 0.5));
  }
}

TEST(FirmwareFrame, RunsOfAboutABlockAnywhere) {
  // 253, 254 and 255 bytes without a zero before, between and behind zeros.
  for (std::size_t run = 252; run <= 256; ++run) {
    for (std::size_t before = 0; before < 4; ++before) {
      for (std::size_t behind = 0; behind < 4; ++behind) {
        expect_round_trip(FrameBytes(before, 0) + FrameBytes(run, 7) + FrameBytes(behind, 0));
      }
    }
  }
}

TEST(FirmwareFrame, ALastEmptyBlockBehindAFullOneIsUnderstood) {
  // 250 bytes and a checksum without zeros are one full block; some encoders add an empty one.
  Random random(2);
  FrameBytes frame;
  do {
    frame = framed(random_payload(random, 250, 0.0));
  } while (frame.size() != 256 || frame[0] != 255);
  FrameBytes longer = frame;
  longer.insert(longer.end() - 1, 1);
  Unframer one, other;
  EXPECT_EQ(one.take(frame), other.take(longer));
  EXPECT_EQ(other.good(), 1);
}

TEST(FirmwareFrame, WhatDoesNotFitIsRefused) {
  const FrameBytes longest(GYROTWIN_PAYLOAD_MAX + 1, 1);
  std::array<std::uint8_t, 2 * GYROTWIN_FRAME_MAX> frame{};
  const auto encode = [&](std::size_t size, std::size_t capacity) {
    return gyrotwin_frame_encode(longest.data(), size, frame.data(), capacity);
  };
  EXPECT_EQ(encode(GYROTWIN_PAYLOAD_MAX + 1, frame.size()), 0u);
  EXPECT_EQ(encode(0, frame.size()), 0u);
  EXPECT_EQ(encode(100, 105), 0u);
  EXPECT_EQ(encode(100, GYROTWIN_FRAME_SIZE(100)), 106u);
  EXPECT_GT(encode(GYROTWIN_PAYLOAD_MAX, GYROTWIN_FRAME_MAX), 0u);
}

TEST(FirmwareDecoder, ZerosBetweenFramesAreNothing) {
  const FrameBytes frame = frame_of(distinct<beat_t>());
  Unframer unframer;
  const FrameBytes zeros(5, 0);
  EXPECT_EQ(unframer.take(zeros + frame + zeros + frame).size(), 2u);
  EXPECT_EQ(unframer.bad(), 0);
}

TEST(FirmwareDecoder, CutAtAnyByteCostsThatFrameAlone) {
  const FrameBytes frame = frame_of(distinct<sensors_t>());
  const FrameBytes next = frame_of(distinct<command_t>());
  for (std::size_t begin = 0; begin < frame.size(); ++begin) {
    for (const std::size_t length : {std::size_t{1}, std::size_t{2}, frame.size() / 3}) {
      if (begin + length > frame.size()) continue;
      FrameBytes cut = frame;
      cut.erase(cut.begin() + static_cast<std::ptrdiff_t>(begin),
                cut.begin() + static_cast<std::ptrdiff_t>(begin + length));
      Unframer unframer;
      const auto payloads = unframer.take(cut + next + next);
      // Without its 0x00 it takes the next one along.
      const bool joined = begin + length == frame.size() && begin > 0;
      ASSERT_EQ(payloads.size(), joined ? 1u : 2u) << begin << " " << length;
      ASSERT_EQ(payloads.back(), encoded(distinct<command_t>()));
      ASSERT_EQ(unframer.bad(), 1);
    }
  }
}

TEST(FirmwareDecoder, EveryFlippedBitIsSeen) {
  const FrameBytes frame = frame_of(distinct<sensors_t>());
  const FrameBytes next = frame_of(distinct<command_t>());
  for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
    FrameBytes flipped = frame;
    flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1u << (bit % 8)));
    Unframer unframer;
    const auto payloads = unframer.take(flipped + next + next);
    const bool joined = bit / 8 + 1 == frame.size();
    ASSERT_EQ(payloads.size(), joined ? 1u : 2u) << bit;
    for (const FrameBytes& payload : payloads) {
      ASSERT_EQ(payload, encoded(distinct<command_t>())) << bit;
    }
    ASSERT_GE(unframer.bad(), 1);
  }
}

TEST(FirmwareDecoder, RandomBytesAreNoFrameAndDoNotHideTheNext) {
  Random random(3);
  std::uniform_int_distribution<int> byte(0, 255);
  std::uniform_int_distribution<int> length(0, 2000);
  const FrameBytes frame = frame_of(distinct<command_t>());
  Unframer unframer;
  for (int round = 0; round < 2000; ++round) {
    FrameBytes noise(static_cast<std::size_t>(length(random)));
    for (auto& b : noise) b = static_cast<std::uint8_t>(byte(random));
    ASSERT_TRUE(unframer.take(noise).empty());
    noise = {0};
    const auto payloads = unframer.take(noise + frame);
    ASSERT_EQ(payloads.size(), 1u);
    ASSERT_EQ(payloads[0], encoded(distinct<command_t>()));
  }
  EXPECT_EQ(unframer.good(), 2000);
}

TEST(FirmwareDecoder, AStreamWithDamageGivesOnlyWhatWasSent) {
  Random random(4);
  std::bernoulli_distribution hit(1e-3);
  std::uniform_int_distribution<int> what(0, 2), bit(0, 7), kind(0, 2);
  const std::array<FrameBytes, 3> payloads{
      encoded(distinct<command_t>()), encoded(distinct<beat_t>()), encoded(distinct<request_t>())};
  constexpr int kFrames = 20000;
  Unframer unframer;
  for (int i = 0; i < kFrames; ++i) {
    FrameBytes damaged;
    for (const std::uint8_t b : framed(payloads[static_cast<std::size_t>(kind(random))])) {
      if (!hit(random)) {
        damaged.push_back(b);
        continue;
      }
      switch (what(random)) {
        case 0:  // lost
          break;
        case 1:  // flipped
          damaged.push_back(static_cast<std::uint8_t>(b ^ (1u << bit(random))));
          break;
        default:  // twice
          damaged.push_back(b);
          damaged.push_back(b);
      }
    }
    for (const FrameBytes& payload : unframer.take(damaged)) {
      ASSERT_NE(std::find(payloads.begin(), payloads.end(), payload), payloads.end());
    }
  }
  // A frame has 265 bytes in the mean: a share exp(-0.265) = 0.77 is not hit; a 0x00 that is
  // doubled harms nobody, one that is lost harms two.
  EXPECT_NEAR(static_cast<double>(unframer.good()) / kFrames, 0.77, 0.02);
  EXPECT_GT(unframer.bad(), 0);
}

/// The frame of the README: lines of four digits of offset, two blanks, up to eight bytes.
FrameBytes readme_frame() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  FrameBytes bytes;
  std::ifstream readme(GYROTWIN_SOURCE_DIR "/services/hardware/firmware/README.md");
  for (std::string line; std::getline(readme, line);) {
    if (line.size() < 8 || line.find_first_not_of(kDigits) != 4 || line.substr(4, 2) != "  ")
      continue;
    std::istringstream pairs(line.substr(6, 23));
    for (unsigned byte = 0; pairs >> std::hex >> byte;) {
      bytes.push_back(static_cast<std::uint8_t>(byte));
    }
  }
  return bytes;
}

TEST(FirmwareFrame, IsThatOfTheReadme) {
  command_t command{};
  command.header = {.rig_id = 7,
                    .source = header_t::HARDWARE,
                    .epoch = 1234567890123456789,
                    .sequence = 41,
                    .tick = 40,
                    .sim_time_ns = 40'000'000,
                    .sender_mono_ns = 1'000'000'000};
  command.mode = command_t::TORQUE_NM;
  command.valid_ticks = 5;
  command.value[0] = -0.5;
  command.for_tick = 40;
  command.owner_epoch = 1234567890123456789;
  command.writer = 1311768467463790320;
  command.counter = 42;
  EXPECT_EQ(frame_of(command), readme_frame());
}

}  // namespace
}  // namespace gyrotwin
