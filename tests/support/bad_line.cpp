#include "tests/support/bad_line.hpp"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <stdexcept>

namespace gyrotwin::support {
namespace {

// Ethernet, IPv4 without options, UDP.
constexpr std::size_t kProtocolAt = 23, kPortAt = 36, kUdpSizeAt = 38, kChecksumAt = 40;
constexpr std::size_t kHeaders = 42;
constexpr int kUdpHeader = 8;

void shell(const std::string& command) {
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
}

/// A process that only keeps a network namespace of its own open.
pid_t keep_namespace() {
  std::array<int, 2> ready;
  if (::pipe(ready.data()) != 0) throw std::runtime_error("pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const char done = ::unshare(CLONE_NEWNET) == 0 ? 'y' : 'n';
    (void)!::write(ready[1], &done, 1);
    for (;;) ::pause();
  }
  char done = 'n';
  (void)!::read(ready[0], &done, 1);
  ::close(ready[0]);
  ::close(ready[1]);
  if (done != 'y') throw std::runtime_error("no network namespace");
  return child;
}

Descriptor open_end(const std::string& interface) {
  Descriptor end(::socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK, htons(ETH_P_IP)));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_IP);
  address.sll_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
  constexpr int kBuffer = 8 << 20;
  ::setsockopt(end.get(), SOL_SOCKET, SO_RCVBUFFORCE, &kBuffer, sizeof kBuffer);
  ::setsockopt(end.get(), SOL_SOCKET, SO_RCVBUF, &kBuffer, sizeof kBuffer);
  if (::bind(end.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("no packet socket on " + interface);
  }
  return end;
}

int number_at(const std::vector<std::uint8_t>& frame, std::size_t at) {
  return frame[at] << 8 | frame[at + 1];
}

std::int64_t now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

bool each(int n, std::int64_t count) { return n != 0 && count % n == 0; }

}  // namespace

BadLine::BadLine(int port, std::array<int, 2> size) : port_(port), size_(size) {
  for (int host = 0; host < 2; ++host) {
    const auto h = static_cast<std::size_t>(host);
    hosts_[h] = keep_namespace();
    const std::string pid = std::to_string(hosts_[h]);
    const std::string near = "line" + std::to_string(host);
    shell("ip link add " + near + " type veth peer name lab0 netns " + pid + " && ip link set " +
          near + " up && nsenter -n -t " + pid +
          " sh -c 'ip link set lo up && ip link set lab0 up && ip address add 198.51.100." +
          std::to_string(host + 1) + "/24 dev lab0'");
    ends_[h] = open_end(near);
  }
}

BadLine::~BadLine() {
  stop();
  // Now, not when the kernel gets round to it: the next line's ends have the same names.
  for (const char* near : {"line0", "line1"}) {
    (void)!std::system(("ip link delete " + std::string(near)).c_str());
  }
  for (const pid_t host : hosts_) {
    if (host < 0) continue;
    ::kill(host, SIGKILL);
    ::waitpid(host, nullptr, 0);
  }
}

std::vector<std::string> BadLine::on_host(int host) const {
  return {"/usr/bin/nsenter", "-n", "-t", std::to_string(hosts_[static_cast<std::size_t>(host)])};
}

void BadLine::start(std::array<LineFaults, 2> faults, std::int64_t delay_ns) {
  stop();
  delay_ns_ = delay_ns;
  for (std::size_t i = 0; i < 2; ++i) {
    ways_[i] = {};
    ways_[i].faults = faults[i];
  }
  carrier_ = std::jthread([this](const std::stop_token& stop) { carry(stop); });
}

std::array<LineCounts, 2> BadLine::stop() {
  carrier_ = {};
  return {ways_[0].counts, ways_[1].counts};
}

void BadLine::carry(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::int64_t sleep = 20'000'000;
    for (int from = 0; from < 2; ++from) {
      Way& way = ways_[static_cast<std::size_t>(from)];
      while (take_frame(from)) {
      }
      while (!way.under_way.empty() && way.under_way.front().due_ns <= now_ns()) {
        const auto& bytes = way.under_way.front().bytes;
        // Into the other host: what this process sends on its end comes in there.
        (void)!::send(ends_[static_cast<std::size_t>(1 - from)].get(), bytes.data(), bytes.size(),
                      0);
        way.under_way.pop_front();
      }
      if (!way.under_way.empty()) {
        sleep = std::min(sleep, std::max<std::int64_t>(0, way.under_way.front().due_ns - now_ns()));
      }
    }
    std::array<pollfd, 2> ready{{{ends_[0].get(), POLLIN, 0}, {ends_[1].get(), POLLIN, 0}}};
    const timespec timeout{.tv_sec = 0, .tv_nsec = sleep};
    ::ppoll(ready.data(), ready.size(), &timeout, nullptr);
  }
}

bool BadLine::take_frame(int from) {
  std::vector<std::uint8_t> bytes(2048);
  sockaddr_ll address{};
  socklen_t size = sizeof address;
  const ssize_t got = ::recvfrom(ends_[static_cast<std::size_t>(from)].get(), bytes.data(),
                                 bytes.size(), 0, reinterpret_cast<sockaddr*>(&address), &size);
  if (got < 0) return false;
  bytes.resize(static_cast<std::size_t>(got));
  if (address.sll_pkttype == PACKET_OUTGOING || bytes.size() < kHeaders ||
      bytes[kProtocolAt] != IPPROTO_UDP || number_at(bytes, kPortAt) != port_) {
    return true;
  }
  // The kernel left the checksum to an adapter that there is not; 0 says that there is none.
  bytes[kChecksumAt] = bytes[kChecksumAt + 1] = 0;
  hand_over(from, std::move(bytes));
  return true;
}

bool BadLine::counts(int from, const std::vector<std::uint8_t>& frame) const {
  return number_at(frame, kUdpSizeAt) - kUdpHeader == size_[static_cast<std::size_t>(from)];
}

void BadLine::hand_over(int from, std::vector<std::uint8_t> bytes) {
  Way& way = ways_[static_cast<std::size_t>(from)];
  const std::int64_t due = now_ns() + delay_ns_;
  if (!counts(from, bytes)) {
    ++way.counts.others;
    way.under_way.push_back({due, std::move(bytes)});
    return;
  }
  const std::int64_t n = ++way.counts.came;
  if (each(way.faults.lose_each, n)) {
    ++way.counts.lost;
    return;
  }
  if (!way.held && each(way.faults.hold_each, n)) {
    ++way.counts.held;
    way.held = std::move(bytes);
    return;
  }
  if (each(way.faults.double_each, n)) {
    ++way.counts.doubled;
    way.under_way.push_back({due, bytes});
  }
  way.under_way.push_back({due, std::move(bytes)});
  if (way.held) {
    way.under_way.push_back({due, std::move(*way.held)});
    way.held.reset();
  }
}

}  // namespace gyrotwin::support
