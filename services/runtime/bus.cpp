#include "services/runtime/bus.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

MulticastSockets open_sockets(const BusConfig& config, int receive_buffer) {
  if (!config.key && config.ttl != 0) {
    throw Error("network.sign = false with network.ttl = " + std::to_string(config.ttl) +
                ": unsigned messages must not leave this host; set network.sign = true, or "
                "network.ttl = 0");
  }
  return open_multicast(config.group, config.port, config.interface, config.ttl, receive_buffer);
}

Bus::Bus(const BusConfig& config)
    : format_(config.prefix, config.rig_id, config.key),
      sockets_(open_sockets(config, kReceiveBuffer)),
      rig_id_(config.rig_id),
      source_(config.source),
      inbox_(sockets_.receiver.get()) {}

std::optional<Reception> Bus::receive() noexcept {
  while (burst_ < kLongestBurst || inbox_.holds()) {
    const auto datagram = inbox_.next();
    if (!datagram) break;
    ++burst_;
    if (sockets_.own(datagram->from)) continue;
    if (const auto reception = judge(datagram->bytes)) return reception;
  }
  burst_ = 0;
  return {};
}

std::optional<Reception> Bus::receive(std::int64_t timeout_ns) noexcept {
  burst_ = 0;
  if (!inbox_.wait(timeout_ns)) return {};
  return receive();
}

bool Bus::wait(std::int64_t timeout_ns) noexcept { return inbox_.wait(timeout_ns); }

const BusCounters& Bus::counters() noexcept {
  counters_.kernel_dropped = sockets_.dropped();
  return counters_;
}

std::optional<Reception> Bus::judge(std::span<const std::uint8_t> datagram) noexcept {
  const Parsed parsed = format_.parse(datagram);
  if (parsed.verdict == Verdict::kGood) return put_in_order(parsed);
  counters_.count(parsed.verdict);
  return {};
}

std::optional<Reception> Bus::put_in_order(const Parsed& parsed) noexcept {
  const auto channel = static_cast<std::size_t>(parsed.channel);
  const auto [place, missing] = order_[channel].hear(parsed.epoch, parsed.sequence);
  if (place == SequenceOrder::Place::kOlder) {
    ++counters_.reordered[channel];
    return {};
  }
  const bool repeat = place == SequenceOrder::Place::kRepeat;
  if (repeat) ++counters_.repeats[channel];
  counters_.gaps[channel] = add_saturating(counters_.gaps[channel], missing);
  ++counters_.received[channel];
  return Reception{parsed.channel, repeat, parsed.payload};
}

bool Bus::send_again(std::string_view channel, std::span<const std::uint8_t> payload) noexcept {
  const std::size_t head = DatagramFormat::begin(outgoing_, channel, packets_++);
  // sendmsg reads from both and writes to neither.
  std::array<iovec, 2> parts{
      {{outgoing_.data(), head}, {const_cast<std::uint8_t*>(payload.data()), payload.size()}}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  const ssize_t taken = sendmsg(sockets_.sender.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  const bool sent = taken == static_cast<ssize_t>(head + payload.size());
  if (!sent) ++counters_.send_failed;
  return sent;
}

void Bus::stamp_header(header_t& header, const Stamp& stamp) const noexcept {
  header.rig_id = rig_id_;
  header.source = source_;
  header.epoch = stamp.epoch;
  header.sequence = stamp.sequence;
  header.tick = stamp.tick;
  header.sim_time_ns = stamp.sim_time_ns;
  header.sender_mono_ns = monotonic_ns();
}

std::uint8_t* Bus::begin_payload(Channel channel) noexcept {
  payload_at_ = format_.begin(outgoing_, channel, packets_++);
  return outgoing_.data() + payload_at_;
}

void Bus::sign_and_send(Channel channel) noexcept {
  const std::size_t size = payload_at_ + spec(channel).size;
  format_.sign(outgoing_, size);
  const ssize_t taken =
      ::send(sockets_.sender.get(), outgoing_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (taken == static_cast<ssize_t>(size)) {
    ++counters_.sent[static_cast<std::size_t>(channel)];
  } else {
    ++counters_.send_failed;
  }
}

}  // namespace gyrotwin
