#include "services/runtime/inbox.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

// The longest sleep in one call. The kernel's own timeout of a socket is coarse and costs nothing
// to arm; what is left of a wait after the last full slice is slept in ppoll, to the microsecond.
constexpr std::int64_t kSlice = 10'000'000;         // [ns]
constexpr std::int64_t kLongestSlice = 2 * kSlice;  // what the kernel's jiffies may make of it

}  // namespace

bool wait_readable(int descriptor, std::int64_t timeout_ns) noexcept {
  const std::int64_t limit = std::max<std::int64_t>(timeout_ns, 0);
  const timespec timeout{.tv_sec = limit / 1'000'000'000, .tv_nsec = limit % 1'000'000'000};
  pollfd ready{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ppoll(&ready, 1, &timeout, nullptr) == 1;
}

Inbox::Inbox(int descriptor) : descriptor_(descriptor) {
  const int flags = fcntl(descriptor_, F_GETFL);
  const timeval slice{.tv_sec = 0, .tv_usec = kSlice / 1000};
  if (flags < 0 || fcntl(descriptor_, F_SETFL, flags & ~O_NONBLOCK) != 0 ||
      setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &slice, sizeof slice) != 0) {
    throw Error(std::string("a socket does not take its timeout: ") + std::strerror(errno));
  }
}

std::optional<Datagram> Inbox::next() noexcept {
  if (!std::exchange(held_, false) && !fetch(MSG_DONTWAIT)) return {};
  return Datagram{from_, std::span<const std::uint8_t>(bytes_).first(size_)};
}

bool Inbox::wait(std::int64_t timeout_ns) noexcept {
  if (held_) return true;
  std::int64_t now = monotonic_ns();
  const std::int64_t end = now + timeout_ns;
  while (end - now >= kLongestSlice) {
    if (fetch(0)) return held_ = true;
    if (errno != EAGAIN) return false;  // a signal
    const std::int64_t before = std::exchange(now, monotonic_ns());
    if (now - before < kSlice / 2) break;  // somebody has made the socket non-blocking
  }
  return held_ = wait_readable(descriptor_, end - now) && fetch(MSG_DONTWAIT);
}

/// @return whether there is one
bool Inbox::fetch(int flags) noexcept {
  socklen_t from_size = sizeof from_;
  const ssize_t size = recvfrom(descriptor_, bytes_.data(), bytes_.size(), flags,
                                reinterpret_cast<sockaddr*>(&from_), &from_size);
  if (size < 0) return false;
  size_ = static_cast<std::size_t>(size);
  return true;
}

}  // namespace gyrotwin
