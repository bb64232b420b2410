#include "services/runtime/multicast.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <random>

#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

constexpr int kSmallestReceiveBuffer = 256 << 10;  // [bytes, as the kernel counts them]

constexpr int kProofTimeoutMs = 1000;

std::string reason() { return std::strerror(errno); }

template <class Value>
void set_option(const Descriptor& socket, int level, int option, const Value& value,
                const std::string& what) {
  if (setsockopt(socket.get(), level, option, &value, sizeof value) != 0) {
    throw Error(what + ": " + reason());
  }
}

const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

sockaddr_in name_of_socket(const Descriptor& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return address;
}

Descriptor open_socket() {
  Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.valid()) throw Error("no UDP socket: " + reason());
  return socket;
}

sockaddr_in group_address(const std::string& group, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(address.sin_addr.s_addr))) {
    throw Error("network.group is `" + group +
                "`; expected an IPv4 multicast group, e.g. \"239.255.76.67\"");
  }
  if (port < 1 || port > 65535) {
    throw Error("network.port is " + std::to_string(port) + "; expected 1 to 65535");
  }
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

struct Interface {
  ip_mreqn index_and_address;
  bool loopback;
};

/// An interface that is up, with its first IPv4 address.
Interface find_interface(const std::string& name) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) throw Error("the network interfaces cannot be listed: " + reason());
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);

  std::string existing;
  std::optional<unsigned> flags;
  std::optional<in_addr> address;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    // Every interface has one packet entry, whatever addresses it has.
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family == AF_PACKET) {
      existing += (existing.empty() ? "" : ", ") + std::string(entry->ifa_name);
    }
    if (name != entry->ifa_name) continue;
    flags = entry->ifa_flags;
    if (!address && entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) {
      address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr;
    }
  }

  const std::string found = "network.interface is `" + name + "`, ";
  if (!flags) {
    throw NotReady(found + "which does not exist; this host has: " + existing +
                   ". Change network.interface in the rig file (`lo` stays on this host)");
  }
  if ((*flags & IFF_UP) == 0) {
    throw NotReady(found + "which is down: `ip link set " + name +
                   " up`, or change network.interface in the rig file; this host has: " + existing);
  }
  if (!address) {
    throw NotReady(found + "which has no IPv4 address: `ip address add ADDRESS/24 dev " + name +
                   "`, or change network.interface in the rig file; this host has: " + existing);
  }
  return {.index_and_address = {.imr_multiaddr = {},
                                .imr_address = *address,
                                .imr_ifindex = static_cast<int>(if_nametoindex(name.c_str()))},
          .loopback = (*flags & IFF_LOOPBACK) != 0};
}

void grow_receive_buffer(const Descriptor& socket, int wanted) {
  // Only who administers the network goes beyond net.core.rmem_max.
  if (setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
    set_option(socket, SOL_SOCKET, SO_RCVBUF, wanted, "SO_RCVBUF");
  }
  int granted = 0;
  socklen_t size = sizeof granted;
  getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  if (granted < kSmallestReceiveBuffer) {
    throw Error("the kernel grants a receive buffer of " + std::to_string(granted) +
                " bytes; at least " + std::to_string(kSmallestReceiveBuffer) +
                " are needed: `sysctl -w net.core.rmem_max=" + std::to_string(wanted) + "`");
  }
}

/// Hears exactly the group, from exactly that interface.
Descriptor open_receiver(sockaddr_in group, const Interface& interface, int buffer) {
  Descriptor socket = open_socket();
  // With SO_REUSEPORT instead, neither liblcm nor a second daemon could open the same port.
  set_option(socket, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  // Bound to the group, unicast does not reach it; by default it would hear groups others joined.
  set_option(socket, IPPROTO_IP, IP_MULTICAST_ALL, 0, "IP_MULTICAST_ALL");
  grow_receive_buffer(socket, buffer);

  const std::string port = std::to_string(ntohs(group.sin_port));
  if (bind(socket.get(), generic(group), sizeof group) != 0) {
    throw Error("UDP port " + port + " cannot be opened: " + reason() + "; `ss -ulpn 'sport = :" +
                port + "'` names who has it: stop that, or change network.port in the rig file");
  }
  ip_mreqn membership = interface.index_and_address;
  membership.imr_multiaddr = group.sin_addr;
  set_option(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership,
             "network.interface does not join network.group");
  return socket;
}

/// Binds a socket on the loopback interface to an address and a port that is nobody else's. Where
/// all of 127/8 is this host's, the address can say the port; the two together are given only once.
bool bind_to_address_of_its_own(const Descriptor& socket) {
  constexpr in_addr_t kFirstAddress = 0x7f800000;                      // 127.128.0.0
  constexpr int kFirstPort = 49152, kLastPort = 65535, kTries = 1000;  // RFC 6335: dynamic ports
  std::random_device random;
  std::uniform_int_distribution<int> ports(kFirstPort, kLastPort);
  for (int i = 0; i < kTries; ++i) {
    const auto port = static_cast<std::uint16_t>(ports(random));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(kFirstAddress | port);
    address.sin_port = htons(port);
    if (bind(socket.get(), generic(address), sizeof address) == 0) return true;
    if (errno != EADDRINUSE) return false;
  }
  return false;
}

/// Speaks from an address of its own where it can, else from the interface's.
Descriptor open_sender(const Interface& interface, int ttl) {
  if (ttl < 0 || ttl > 255) {
    throw Error("network.ttl is " + std::to_string(ttl) +
                "; expected 0 (this host only) or 1 (this subnet), 255 at most");
  }
  Descriptor socket = open_socket();
  set_option(socket, IPPROTO_IP, IP_MULTICAST_IF, interface.index_and_address, "IP_MULTICAST_IF");
  set_option(socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl, "IP_MULTICAST_TTL");
  set_option(socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1, "IP_MULTICAST_LOOP");
  if (interface.loopback && bind_to_address_of_its_own(socket)) return socket;

  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = interface.index_and_address.imr_address;
  if (bind(socket.get(), generic(address), sizeof address) != 0) {
    throw Error("no UDP port to send from: " + reason());
  }
  return socket;
}

/// Keeps from the receiver what comes from an address: that its own sender said would wake it up. A
/// kernel that does not do it costs time, and nothing else.
void close_to(const Descriptor& receiver, const sockaddr_in& group, const sockaddr_in& source,
              const ip_mreqn& interface) {
  group_source_req request{};
  request.gsr_interface = static_cast<std::uint32_t>(interface.imr_ifindex);
  std::memcpy(&request.gsr_group, &group, sizeof group);
  std::memcpy(&request.gsr_source, &source, sizeof source);
  setsockopt(receiver.get(), IPPROTO_IP, MCAST_BLOCK_SOURCE, &request, sizeof request);
}

/// What a firewall or a lost route would silence must fail now. The port is nobody else's, so that
/// no running program hears this.
void prove(const Descriptor& sender, sockaddr_in group, const Interface& interface) {
  group.sin_port = 0;
  const Descriptor receiver = open_receiver(group, interface, kSmallestReceiveBuffer);
  group.sin_port = name_of_socket(receiver).sin_port;

  constexpr char probe = 0;
  const std::string fix =
      "; look at `nft list ruleset`, `ip route` and, in a service, IPAddressAllow=, or change "
      "network.interface in the rig file";
  if (sendto(sender.get(), &probe, 1, 0, generic(group), sizeof group) != 1) {
    throw Error("network.interface takes no multicast datagram: " + reason() + fix);
  }
  pollfd ready{.fd = receiver.get(), .events = POLLIN, .revents = 0};
  if (poll(&ready, 1, kProofTimeoutMs) != 1) {
    throw Error("a datagram to network.group does not come back on network.interface" + fix);
  }
}

}  // namespace

MulticastSockets open_multicast(const std::string& group, int port, const std::string& interface,
                                int ttl, int receive_buffer) {
  const sockaddr_in address = group_address(group, port);
  const Interface device = find_interface(interface);
  MulticastSockets sockets;
  sockets.receiver = open_receiver(address, device, receive_buffer);
  sockets.sender = open_sender(device, ttl);
  prove(sockets.sender, address, device);
  if (connect(sockets.sender.get(), generic(address), sizeof address) != 0) {
    throw Error("network.group cannot be reached through network.interface: " + reason());
  }
  sockets.own_address = name_of_socket(sockets.sender);
  const ip_mreqn& shared = device.index_and_address;
  if (sockets.own_address.sin_addr.s_addr != shared.imr_address.s_addr) {
    close_to(sockets.receiver, address, sockets.own_address, shared);
  }
  return sockets;
}

std::int64_t MulticastSockets::dropped() noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (getsockopt(receiver.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0) {
    const std::uint32_t drops = memory[SK_MEMINFO_DROPS];
    dropped_ += drops - kernel_drops_;
    kernel_drops_ = drops;
  }
  return dropped_;
}

}  // namespace gyrotwin
