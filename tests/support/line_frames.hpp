// Frames on the line to a device, for tests: the firmware's own code, in C++ containers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/hardware/firmware/gyrotwin_frame.h"
#include "tests/support/distinct.hpp"

namespace gyrotwin {

using FrameBytes = std::vector<std::uint8_t>;

/// The frame of a payload; empty where there is none.
inline FrameBytes framed(std::span<const std::uint8_t> payload) {
  FrameBytes frame(GYROTWIN_FRAME_SIZE(payload.size()));
  frame.resize(gyrotwin_frame_encode(payload.data(), payload.size(), frame.data(), frame.size()));
  return frame;
}

/// The frame of an LCM message.
template <class Message>
FrameBytes frame_of(const Message& message) {
  return framed(encoded(message));
}

/// A decoder and what it has found.
class Unframer {
 public:
  Unframer() { gyrotwin_decoder_init(&decoder_); }

  /// Payloads that these bytes complete.
  std::vector<FrameBytes> take(std::span<const std::uint8_t> bytes) {
    std::vector<FrameBytes> payloads;
    for (const std::uint8_t byte : bytes) {
      if (const std::size_t size = gyrotwin_decoder_take(&decoder_, byte)) {
        payloads.emplace_back(decoder_.bytes, decoder_.bytes + size);
      }
    }
    return payloads;
  }

  std::int64_t good() const { return decoder_.good; }
  std::int64_t bad() const { return decoder_.bad; }

 private:
  gyrotwin_decoder decoder_;
};

/// Decodes as a message where the payload is one. @return whether it is
template <class Message>
bool decode(const FrameBytes& payload, Message& message) {
  return payload.size() == kWireSize<Message> &&
         message.decode(payload.data(), 0, static_cast<int>(payload.size())) ==
             static_cast<int>(payload.size());
}

}  // namespace gyrotwin
