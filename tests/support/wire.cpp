#include "tests/support/wire.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/runtime/clock.hpp"

namespace gyrotwin::support {

namespace {

constexpr int kBuffer = 16 << 20;              // [bytes] of each port, each way
constexpr std::int64_t kTurn = 2'000'000;      // [ns] a sleep at the longest
constexpr std::size_t kLongestFrame = 70'000;  // segments may come unsplit
constexpr std::size_t kVnetHeader = 10;        // [bytes] virtio_net_hdr before every frame

template <class Value>
void set_option(int socket, int level, int option, const Value& value) {
  if (::setsockopt(socket, level, option, &value, sizeof value) != 0) {
    throw std::runtime_error("a packet socket does not take option " + std::to_string(option));
  }
}

/// Hears what comes into an interface and speaks out of it.
Descriptor open_port(const std::string& interface) {
  Descriptor socket(::socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.valid()) throw std::runtime_error("no packet socket: CAP_NET_RAW is needed");
  // With this header a checksum that the sender left to its "hardware" stays so.
  set_option(socket.get(), SOL_PACKET, PACKET_VNET_HDR, 1);
  set_option(socket.get(), SOL_PACKET, PACKET_IGNORE_OUTGOING, 1);
  set_option(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, kBuffer);
  set_option(socket.get(), SOL_SOCKET, SO_SNDBUFFORCE, kBuffer);
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  if (address.sll_ifindex == 0 ||
      ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("no interface " + interface);
  }
  return socket;
}

std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

}  // namespace

Wire::Wire(const std::vector<std::string>& interfaces, std::uint64_t seed)
    : cut_(interfaces.size(), false), random_(seed), free_at_(interfaces.size(), 0) {
  for (const std::string& interface : interfaces) ports_.push_back(open_port(interface));
  thread_ = std::thread([this] { work(); });
  // A cable waits for nobody. Where this is not granted it is as punctual as the others.
  const sched_param first{.sched_priority = 85};
  ::pthread_setschedparam(thread_.native_handle(), SCHED_FIFO, &first);
}

Wire::~Wire() {
  stopping_ = true;
  thread_.join();
}

void Wire::set(const Troubles& troubles) {
  const std::lock_guard lock(mutex_);
  troubles_ = troubles;
}

void Wire::cut(std::size_t port, bool is_cut) {
  const std::lock_guard lock(mutex_);
  cut_[port] = is_cut;
}

void Wire::work() {
  const MonotonicClock clock;
  std::vector<pollfd> ready;
  for (const Descriptor& port : ports_) ready.push_back({port.get(), POLLIN, 0});
  while (!stopping_) {
    std::int64_t sleep = kTurn;
    if (!on_their_way_.empty()) {
      sleep = std::clamp<std::int64_t>(on_their_way_.top().due_ns - clock.now_ns(), 0, kTurn);
    }
    const timespec timeout{.tv_sec = 0, .tv_nsec = sleep};
    ::ppoll(ready.data(), ready.size(), &timeout, nullptr);
    for (std::size_t port = 0; port < ports_.size(); ++port) {
      if (ready[port].revents != 0) take_from(port, clock.now_ns());
    }
    deliver(clock.now_ns());
  }
}

void Wire::take_from(std::size_t port, std::int64_t now) {
  constexpr int kBurst = 64;  // then the other ports have their turn
  Bytes frame(kLongestFrame);
  for (int i = 0; i < kBurst; ++i) {
    const ssize_t size = ::recv(ports_[port].get(), frame.data(), frame.size(), 0);
    if (size <= 0) return;
    const Bytes whole(frame.begin(), frame.begin() + size);
    const std::lock_guard lock(mutex_);
    for (std::size_t to = 0; to < ports_.size(); ++to) {
      if (to == port || cut_[port] || cut_[to] || happens(troubles_.loss)) continue;
      schedule(whole, to, now);
      if (happens(troubles_.duplicated)) schedule(whole, to, now);
    }
  }
}

void Wire::schedule(const Bytes& frame, std::size_t port, std::int64_t now) {
  std::int64_t due = now;
  if (troubles_.rate_bit_s > 0.0) {
    const double bits = 8.0 * static_cast<double>(frame.size() - kVnetHeader);
    const std::int64_t begins = std::max(now, free_at_[port]);
    if (begins - now > nanoseconds(troubles_.longest_queue_s)) return;
    due = free_at_[port] = begins + nanoseconds(bits / troubles_.rate_bit_s);
  }
  const double jitter =
      troubles_.jitter_s > 0.0 ? troubles_.jitter_s * (2.0 * uniform_(random_) - 1.0) : 0.0;
  due += nanoseconds(troubles_.delay_s + jitter);
  if (happens(troubles_.overtaken)) due += nanoseconds(troubles_.overtaken_s);
  on_their_way_.push({due, ++copies_, port, frame});
}

void Wire::deliver(std::int64_t now) {
  while (!on_their_way_.empty() && on_their_way_.top().due_ns <= now) {
    const Copy& copy = on_their_way_.top();
    bool arrives = false;
    {
      const std::lock_guard lock(mutex_);
      arrives = !cut_[copy.port];
    }
    if (arrives) ::send(ports_[copy.port].get(), copy.frame.data(), copy.frame.size(), 0);
    on_their_way_.pop();
  }
}

}  // namespace gyrotwin::support
