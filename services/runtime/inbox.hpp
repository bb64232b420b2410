// Datagrams of a socket, one by one, with a sleep that takes the next one along.
#pragma once

#include <netinet/in.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Sleeps until a datagram may wait or `timeout_ns` have passed. @return whether one may wait.
bool wait_readable(int descriptor, std::int64_t timeout_ns) noexcept;

/// A datagram; its bytes are valid until the inbox is used again.
struct Datagram {
  const sockaddr_in& from;
  std::span<const std::uint8_t> bytes;
};

/// Sleeping and taking what ended the sleep is one system call. Not thread-safe.
class Inbox {
 public:
  /// @param descriptor outlives the inbox; made blocking here
  /// @throws Error when it is no socket that can be made so
  explicit Inbox(int descriptor);
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  /// The next datagram, without waiting. Empty when there is none.
  std::optional<Datagram> next() noexcept;

  /// Whether next() has one that the socket no longer has: who sleeps on the descriptor takes it
  /// first.
  bool holds() const noexcept { return held_; }

  /// Sleeps until next() has a datagram, or `timeout_ns` have passed; less on a signal. @return
  /// whether it has one.
  bool wait(std::int64_t timeout_ns) noexcept;

 private:
  bool fetch(int flags) noexcept;

  int descriptor_;
  // One byte more than any message has, so that a longer datagram cannot pass for one.
  std::array<std::uint8_t, kMaxDatagram + 1> bytes_;
  std::size_t size_ = 0;
  sockaddr_in from_{};
  bool held_ = false;
};

}  // namespace gyrotwin
