// The floors: bytes of a STATE and of a COMMAND between two processes over UDP, nothing made of
// them. Between two connected sockets, and in a multicast group, as a bus needs it.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "messages/channels.hpp"
#include "services/runtime/multicast.hpp"
#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {
namespace {

using State = std::array<std::uint8_t, kWireSize<state_t>>;
using Command = std::array<std::uint8_t, kWireSize<command_t>>;
static_assert(State().size() > Command().size());  // who hears tells them apart by their sizes

constexpr std::uint16_t kNearPort = 21001, kFarPort = 21002, kGroupPort = 21008;

/// Where an end hears and where it speaks.
struct Sockets {
  Descriptor hears, speaks;
};

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

Descriptor connected(std::uint16_t from, std::uint16_t to) {
  Descriptor socket(::socket(AF_INET, SOCK_DGRAM, 0));
  const sockaddr_in own = loopback(from), peer = loopback(to);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      connect(socket.get(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer) != 0) {
    throw std::runtime_error("raw UDP: ports 21001 and 21002 are not free");
  }
  return socket;
}

Sockets connected_pair(std::uint16_t from, std::uint16_t to) {
  Descriptor socket = connected(from, to);
  Descriptor again(dup(socket.get()));
  return {std::move(socket), std::move(again)};
}

Sockets in_group() {
  constexpr int kReceiveBuffer = 1 << 20;
  MulticastSockets sockets = open_multicast("239.255.71.239", kGroupPort, "lo", 0, kReceiveBuffer);
  fcntl(sockets.receiver.get(), F_SETFL, 0);  // blocking
  return {std::move(sockets.receiver), std::move(sockets.sender)};
}

class RawNear final : public Near {
 public:
  explicit RawNear(Sockets sockets) : sockets_(std::move(sockets)) { be_patient(true); }

  bool there_and_back() override {
    ++sequence_;
    std::memcpy(state_.data(), &sequence_, sizeof sequence_);
    send(sockets_.speaks.get(), state_.data(), state_.size(), 0);
    std::int64_t answered = 0;
    while (answered != sequence_) {
      const ssize_t size = recv(sockets_.hears.get(), heard_.data(), heard_.size(), 0);
      if (size < 0) return false;
      if (size == std::ssize(Command())) std::memcpy(&answered, heard_.data(), sizeof answered);
    }
    if (!met_) be_patient(false);
    return met_ = true;
  }

 private:
  /// A timeout costs; once the two have met, nothing is lost on `lo`.
  void be_patient(bool patient) {
    const timeval limit{.tv_sec = 0, .tv_usec = patient ? 1000 * kPatienceMs : 0};
    setsockopt(sockets_.hears.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }

  Sockets sockets_;
  bool met_ = false;
  std::int64_t sequence_ = 0;
  State state_{}, heard_{};
};

class RawFar final : public Far {
 public:
  explicit RawFar(Sockets sockets) : sockets_(std::move(sockets)) {}

  void answer() override {
    const ssize_t size = recv(sockets_.hears.get(), heard_.data(), heard_.size(), 0);
    if (size != std::ssize(State())) return;
    std::memcpy(command_.data(), heard_.data(), sizeof(std::int64_t));
    send(sockets_.speaks.get(), command_.data(), command_.size(), 0);
  }

 private:
  Sockets sockets_;
  State heard_{};
  Command command_{};
};

}  // namespace

std::unique_ptr<Near> raw_udp_near() {
  return std::make_unique<RawNear>(connected_pair(kNearPort, kFarPort));
}
std::unique_ptr<Far> raw_udp_far() {
  return std::make_unique<RawFar>(connected_pair(kFarPort, kNearPort));
}
std::unique_ptr<Near> raw_multicast_near() { return std::make_unique<RawNear>(in_group()); }
std::unique_ptr<Far> raw_multicast_far() { return std::make_unique<RawFar>(in_group()); }

}  // namespace gyrotwin::bench
