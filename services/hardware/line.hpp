// The line to a device: a terminal that may come and go, and the frames on it. Nothing blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "messages/channels.hpp"
#include "services/hardware/firmware/gyrotwin_frame.h"
#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// Counts since the line was made.
struct LineCounters {
  std::int64_t received = 0;  ///< good frames
  std::int64_t bad = 0;       ///< wrong checksum, length or type
  std::int64_t dropped = 0;   ///< frames that the line took too slowly: the oldest go first
  std::int64_t opened = 0;    ///< times
};

/// One terminal at one path. Not thread-safe. Neither blocks nor allocates once made.
class Line {
 public:
  /// @param path of a tty: USB CDC, UART or pty
  /// @param baud of a UART; 0 leaves the rate as it is
  /// @throws Error where the path is there and no terminal, or a terminal cannot have that rate
  Line(std::string path, int baud);

  /// Opens the terminal, raw and at its rate, where it is closed and there. @return whether it is
  /// open
  bool open() noexcept;
  void close() noexcept;
  bool is_open() const noexcept { return terminal_.valid(); }
  /// errno of the last open() that failed, or of what closed the line; 0: none.
  int error() const noexcept { return error_; }
  int descriptor() const noexcept { return terminal_.get(); }
  /// Frames wait for the terminal to take more.
  bool pending() const noexcept { return waiting_ > 0; }
  const std::string& path() const noexcept { return path_; }

  /// Next payload that has come; valid until the next call. Empty when nothing more waits, or when
  /// so many bytes were read since the last empty result that a flood might hold the caller.
  std::span<const std::uint8_t> receive() noexcept;
  /// A payload that is no message of a device is a bad frame.
  void reject() noexcept { ++rejected_; }

  /// Decodes a payload. @return whether it is a message of this type
  template <class Message>
  static bool decode(std::span<const std::uint8_t> payload, Message& message) noexcept {
    static const std::uint64_t fingerprint = static_cast<std::uint64_t>(Message::getHash());
    if (payload.size() != kWireSize<Message> || type_of(payload) != fingerprint) return false;
    message = {};
    message.decode(payload.data(), 0, static_cast<int>(payload.size()));
    return true;
  }

  /// Queues a message and writes what the terminal takes. Too many waiting: the oldest that has not
  /// begun to go out is dropped.
  template <class Message>
  void send(Message& message) noexcept {
    static_assert(kWireSize<Message> <= GYROTWIN_PAYLOAD_MAX);
    std::memset(message.mac, 0, sizeof message.mac);
    std::array<std::uint8_t, kWireSize<Message>> payload;
    message.encode(payload.data(), 0, static_cast<int>(payload.size()));
    if constexpr (std::is_same_v<Message, command_t>) drop_commands();  // the newest counts
    queue(payload, std::is_same_v<Message, command_t>);
  }
  /// Commands that have not begun to go out never do.
  void drop_commands() noexcept;
  /// Writes what waits, as far as the terminal takes it.
  void flush() noexcept;

  LineCounters counters() const noexcept;

 private:
  struct Frame {
    std::array<std::uint8_t, GYROTWIN_FRAME_MAX> bytes;
    std::size_t size;
    bool command;
  };
  static constexpr std::size_t kFrames = 32;
  static constexpr int kBurst = 65536;  // bytes

  static std::uint64_t type_of(std::span<const std::uint8_t> payload) noexcept;
  void queue(std::span<const std::uint8_t> payload, bool command) noexcept;
  void drop(std::size_t place) noexcept;
  bool refill() noexcept;
  void lose(int error) noexcept;

  std::string path_;
  int baud_;
  Descriptor terminal_;
  int error_ = 0;

  gyrotwin_decoder decoder_;
  std::array<std::uint8_t, 4096> incoming_;
  std::size_t read_ = 0, taken_ = 0;  // bytes of incoming_
  int burst_ = 0;

  std::array<Frame, kFrames> outgoing_;
  std::size_t first_ = 0, waiting_ = 0;  // frames
  std::size_t gone_ = 0;                 // bytes of the first one that are out

  std::int64_t rejected_ = 0, dropped_ = 0, opened_ = 0;
};

}  // namespace gyrotwin
