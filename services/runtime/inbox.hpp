// Datagrams of a socket, fetched several at a time.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

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

/// One system call sleeps, takes the first datagram and all that wait behind it: what is heard once
/// a tick costs one a tick. Not thread-safe.
class Inbox {
 public:
  /// @param descriptor outlives the inbox; made blocking here
  /// @throws Error when it is no socket that can be made so
  explicit Inbox(int descriptor);
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  /// The next datagram, without waiting. Empty once when all that waited is taken.
  std::optional<Datagram> next() noexcept;

  /// Whether next() has one that the socket no longer has: who sleeps on the descriptor takes it
  /// first.
  bool holds() const noexcept { return taken_ < fetched_; }

  /// Sleeps until next() has a datagram, or `timeout_ns` have passed; less on a signal. @return
  /// whether it has one.
  bool wait(std::int64_t timeout_ns) noexcept;

  /// Datagrams for which the socket's buffer had no room.
  std::int64_t dropped() const noexcept { return dropped_; }

 private:
  static constexpr std::size_t kBatch = 8;

  struct Slot {
    // One byte more than any message has, so that a longer datagram cannot pass for one.
    std::array<std::uint8_t, kMaxDatagram + 1> bytes;
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control;
    sockaddr_in from;
    iovec buffer;
  };

  bool fetch(int flags) noexcept;
  void note_drops(msghdr& message) noexcept;

  int descriptor_;
  std::array<Slot, kBatch> slots_{};
  std::array<mmsghdr, kBatch> messages_{};
  std::size_t fetched_ = 0;   // by the last system call
  std::size_t taken_ = 0;     // of these
  bool emptied_ = false;      // the last system call left nothing in the socket
  std::uint32_t kernel_ = 0;  // the kernel's own count of what it dropped, which wraps
  std::int64_t dropped_ = 0;
};

}  // namespace gyrotwin
