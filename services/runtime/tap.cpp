#include "services/runtime/tap.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

constexpr std::size_t kLargestDatagram = 65'507;  // that UDP over IPv4 has

/// When the kernel had a datagram; now, where it does not say.
std::int64_t arrival_us(msghdr& message) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec time{};
    std::memcpy(&time, CMSG_DATA(c), sizeof time);
    return nanoseconds(time) / 1000;
  }
  return wall_ns() / 1000;
}

bool visible(std::string_view name) noexcept {
  return std::ranges::all_of(name, [](char c) { return c > ' ' && c <= '~'; });
}

}  // namespace

Tap::Tap(const BusConfig& config, Keep keep)
    : format_(config.prefix, config.rig_id, config.key),
      sockets_(open_sockets(config, kReceiveBuffer)),
      keep_(keep),
      // One byte more than any message has, so that a longer datagram cannot pass for one.
      incoming_(keep == Keep::kAll ? kLargestDatagram : kMaxDatagram + 1) {
  const int receiver = sockets_.receiver.get();
  constexpr int on = 1;
  if (setsockopt(receiver, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0) {
    throw Error("the kernel does not stamp datagrams with their time: " +
                std::string(std::strerror(errno)));
  }
  socklen_t size = sizeof granted_;
  getsockopt(receiver, SOL_SOCKET, SO_RCVBUF, &granted_, &size);
}

std::optional<Overheard> Tap::receive() noexcept {
  while (burst_ < kLongestBurst) {
    std::int64_t received_us = 0;
    const auto size = read(received_us);
    if (!size) break;
    ++burst_;
    const Parsed parsed = format_.parse(std::span(incoming_).first(*size));
    if (judge(parsed)) return Overheard{parsed.name, received_us, parsed.payload};
  }
  burst_ = 0;
  return {};
}

bool Tap::wait(std::int64_t timeout_ns) noexcept {
  return wait_readable(sockets_.receiver.get(), timeout_ns);
}

const BusCounters& Tap::counters() noexcept {
  counters_.kernel_dropped = sockets_.dropped();
  return counters_;
}

std::optional<std::size_t> Tap::read(std::int64_t& received_us) noexcept {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control;
  iovec buffer{.iov_base = incoming_.data(), .iov_len = incoming_.size()};
  msghdr message{};
  message.msg_iov = &buffer;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(sockets_.receiver.get(), &message, 0);
  if (size < 0) return {};
  received_us = arrival_us(message);
  return static_cast<std::size_t>(size);
}

/// @return whether it is kept
bool Tap::judge(const Parsed& parsed) noexcept {
  if (parsed.verdict == Verdict::kGood) {
    put_in_order(parsed);
    return true;
  }
  counters_.count(parsed.verdict);
  return keep_ == Keep::kAll && parsed.verdict == Verdict::kForeign && !parsed.name.empty() &&
         visible(parsed.name);
}

void Tap::put_in_order(const Parsed& parsed) noexcept {
  const auto channel = static_cast<std::size_t>(parsed.channel);
  const auto [place, missing] = order_[channel].hear(parsed.epoch, parsed.sequence);
  ++counters_.received[channel];
  counters_.gaps[channel] = add_saturating(counters_.gaps[channel], missing);
  if (place == SequenceOrder::Place::kRepeat) ++counters_.repeats[channel];
  if (place == SequenceOrder::Place::kOlder) ++counters_.reordered[channel];
}

}  // namespace gyrotwin
