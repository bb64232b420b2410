// The floor: bytes of a STATE and of a COMMAND between two connected UDP sockets, nothing made of
// them.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "messages/channels.hpp"
#include "services/runtime/descriptor.hpp"
#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {
namespace {

constexpr std::uint16_t kNearPort = 21001, kFarPort = 21002;

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

class RawNear final : public Near {
 public:
  RawNear() : socket_(connected(kNearPort, kFarPort)) { be_patient(true); }

  bool there_and_back() override {
    ++sequence_;
    std::memcpy(state_.data(), &sequence_, sizeof sequence_);
    send(socket_.get(), state_.data(), state_.size(), 0);
    std::int64_t answered = 0;
    while (answered != sequence_) {
      if (recv(socket_.get(), command_.data(), command_.size(), 0) < 0) return false;
      std::memcpy(&answered, command_.data(), sizeof answered);
    }
    if (!met_) be_patient(false);
    return met_ = true;
  }

 private:
  /// A timeout costs; once the two have met, nothing is lost on `lo`.
  void be_patient(bool patient) {
    const timeval limit{.tv_sec = 0, .tv_usec = patient ? 1000 * kPatienceMs : 0};
    setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }

  Descriptor socket_;
  bool met_ = false;
  std::int64_t sequence_ = 0;
  std::array<std::uint8_t, kWireSize<state_t>> state_{};
  std::array<std::uint8_t, kWireSize<command_t>> command_{};
};

class RawFar final : public Far {
 public:
  RawFar() : socket_(connected(kFarPort, kNearPort)) {}

  void answer() override {
    if (recv(socket_.get(), state_.data(), state_.size(), 0) < 0) return;
    std::memcpy(command_.data(), state_.data(), sizeof(std::int64_t));
    send(socket_.get(), command_.data(), command_.size(), 0);
  }

 private:
  Descriptor socket_;
  std::array<std::uint8_t, kWireSize<state_t>> state_{};
  std::array<std::uint8_t, kWireSize<command_t>> command_{};
};

}  // namespace

std::unique_ptr<Near> raw_udp_near() { return std::make_unique<RawNear>(); }
std::unique_ptr<Far> raw_udp_far() { return std::make_unique<RawFar>(); }

}  // namespace gyrotwin::bench
