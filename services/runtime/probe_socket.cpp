#include "services/runtime/probe_socket.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "services/runtime/clock.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin::netcheck {
namespace {

void ask_for(const Descriptor& socket, int level, int option, const std::string& what) {
  constexpr int on = 1;
  if (setsockopt(socket.get(), level, option, &on, sizeof on) != 0) {
    throw Error("the kernel does not tell " + what + ": " + std::strerror(errno));
  }
}

int mtu_of(const Descriptor& socket, const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  return ioctl(socket.get(), SIOCGIFMTU, &request) == 0 ? request.ifr_mtu : 0;
}

template <class Value>
Value value_of(cmsghdr* entry) noexcept {
  Value value{};
  std::memcpy(&value, CMSG_DATA(entry), sizeof value);
  return value;
}

}  // namespace

std::string address_text(const sockaddr_in& address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &address.sin_addr, text, sizeof text);
  return text;
}

std::string interface_name(int index) {
  char name[IF_NAMESIZE] = {};
  if_indextoname(static_cast<unsigned>(index), name);
  return name;
}

ProbeSocket::ProbeSocket(const BusConfig& config)
    : format_(config.prefix, config.rig_id, config.key),
      sockets_(open_sockets(config, Bus::kReceiveBuffer)),
      mtu_(mtu_of(sockets_.receiver, config.interface)) {
  ask_for(sockets_.receiver, SOL_SOCKET, SO_TIMESTAMPNS, "when a datagram came");
  ask_for(sockets_.receiver, IPPROTO_IP, IP_RECVTTL, "a datagram's TTL");
  ask_for(sockets_.receiver, IPPROTO_IP, IP_PKTINFO, "a datagram's interface");
  socklen_t size = sizeof granted_;
  getsockopt(sockets_.receiver.get(), SOL_SOCKET, SO_RCVBUF, &granted_, &size);
}

std::optional<Arrival> ProbeSocket::receive() noexcept {
  while (burst_ < kLongestBurst) {
    Arrival arrival;
    const auto size = read(arrival);
    if (!size) break;
    ++burst_;
    if (sockets_.own(arrival.from)) continue;
    const auto judged = format_.judge(std::span(incoming_).first(*size));
    arrival.probe = judged.probe;
    if (judged.verdict == Verdict::kGood) return arrival;
    counters_.count(judged.verdict);
  }
  burst_ = 0;
  return {};
}

bool ProbeSocket::wait(std::int64_t timeout_ns) noexcept {
  return wait_readable(sockets_.receiver.get(), timeout_ns);
}

const ProbeCounters& ProbeSocket::counters() noexcept {
  counters_.kernel_dropped = sockets_.dropped();
  return counters_;
}

void ProbeSocket::send(const Probe& probe) noexcept {
  const std::size_t size = format_.write(outgoing_, probe);
  const ssize_t taken =
      ::send(sockets_.sender.get(), outgoing_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (taken != static_cast<ssize_t>(size)) ++counters_.send_failed;
}

std::optional<std::size_t> ProbeSocket::read(Arrival& arrival) noexcept {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(in_pktinfo)) +
                                        CMSG_SPACE(sizeof(int))>
      control;
  iovec buffer{.iov_base = incoming_.data(), .iov_len = incoming_.size()};
  msghdr message{};
  message.msg_name = &arrival.from;
  message.msg_namelen = sizeof arrival.from;
  message.msg_iov = &buffer;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = recvmsg(sockets_.receiver.get(), &message, 0);
  if (size < 0) return {};
  take_note(message, arrival);
  return static_cast<std::size_t>(size);
}

void ProbeSocket::take_note(msghdr& message, Arrival& arrival) noexcept {
  arrival.received_ns = wall_ns();
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SCM_TIMESTAMPNS) {
      arrival.received_ns = nanoseconds(value_of<timespec>(c));
    } else if (c->cmsg_level == IPPROTO_IP && c->cmsg_type == IP_TTL) {
      arrival.ttl = value_of<int>(c);
    } else if (c->cmsg_level == IPPROTO_IP && c->cmsg_type == IP_PKTINFO) {
      arrival.interface = value_of<in_pktinfo>(c).ipi_ifindex;
    }
  }
}

}  // namespace gyrotwin::netcheck
