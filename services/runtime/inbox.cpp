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
  if (taken_ == fetched_) {
    const bool nothing_waits = emptied_;
    emptied_ = false;
    if (nothing_waits || !fetch(MSG_DONTWAIT)) return {};
  }
  const std::size_t i = taken_++;
  note_drops(messages_[i].msg_hdr);
  return Datagram{slots_[i].from,
                  std::span<const std::uint8_t>(slots_[i].bytes).first(messages_[i].msg_len)};
}

bool Inbox::wait(std::int64_t timeout_ns) noexcept {
  if (holds()) return true;
  emptied_ = false;
  std::int64_t now = monotonic_ns();
  const std::int64_t end = now + timeout_ns;
  while (end - now >= kLongestSlice) {
    if (fetch(MSG_WAITFORONE)) return true;
    if (errno != EAGAIN) return false;  // a signal
    const std::int64_t before = std::exchange(now, monotonic_ns());
    if (now - before < kSlice / 2) break;  // somebody has made the socket non-blocking
  }
  return wait_readable(descriptor_, end - now);
}

/// @return whether there is at least one
bool Inbox::fetch(int flags) noexcept {
  for (std::size_t i = 0; i < kBatch; ++i) {
    Slot& slot = slots_[i];
    slot.buffer = {.iov_base = slot.bytes.data(), .iov_len = slot.bytes.size()};
    messages_[i].msg_hdr = {.msg_name = &slot.from,
                            .msg_namelen = sizeof slot.from,
                            .msg_iov = &slot.buffer,
                            .msg_iovlen = 1,
                            .msg_control = slot.control.data(),
                            .msg_controllen = slot.control.size(),
                            .msg_flags = 0};
  }
  const int count = recvmmsg(descriptor_, messages_.data(), kBatch, flags, nullptr);
  taken_ = 0;
  fetched_ = static_cast<std::size_t>(std::max(count, 0));
  emptied_ = count > 0 && fetched_ < kBatch;
  return fetched_ > 0;
}

/// The kernel tells how many it has dropped with a datagram.
void Inbox::note_drops(msghdr& message) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t drops = 0;
    std::memcpy(&drops, CMSG_DATA(c), sizeof drops);
    dropped_ += drops - kernel_;
    kernel_ = drops;
  }
}

}  // namespace gyrotwin
