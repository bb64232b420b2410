// What a test needs to speak to a bus without using one: addresses of its own, hand-made LCM short
// messages, and a socket that sends any bytes.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/bus.hpp"

namespace gyrotwin {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::int32_t kTestRig = 7;
inline constexpr std::int64_t kSecond = 1'000'000'000;

/// A key of 32 different bytes.
inline Key test_key() {
  Key key;
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::uint8_t>(i);
  return key;
}

/// A bus on `lo`, on a group and port that belong to this process.
inline BusConfig test_config(std::optional<Key> key = {}) {
  const auto pid = static_cast<unsigned>(getpid());
  return {.prefix = "TEST",
          .rig_id = kTestRig,
          .source = header_t::SIMULATION,
          .group = "239.195." + std::to_string(pid / 250 % 250) + "." + std::to_string(pid % 250),
          .port = static_cast<int>(20000 + pid % 10000),
          .interface = "lo",
          .ttl = 0,
          .key = key};
}

/// `LC02`, packet number 0, name, NUL, payload.
inline Bytes short_message(std::string_view channel, std::span<const std::uint8_t> payload) {
  std::string bytes("LC02\0\0\0\0", 8);
  bytes.append(channel).push_back('\0');
  bytes.append(payload.begin(), payload.end());
  return {bytes.begin(), bytes.end()};
}

/// Sends any bytes to a bus's group.
class RawPeer {
 public:
  explicit RawPeer(const BusConfig& config) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    group_.sin_family = AF_INET;
    group_.sin_port = htons(static_cast<std::uint16_t>(config.port));
    inet_pton(AF_INET, config.group.c_str(), &group_.sin_addr);
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(socket_.get(), IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
    constexpr int ttl = 0;
    setsockopt(socket_.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  }

  void send(std::span<const std::uint8_t> bytes) {
    const ssize_t sent = sendto(socket_.get(), bytes.data(), bytes.size(), 0,
                                reinterpret_cast<const sockaddr*>(&group_), sizeof group_);
    if (sent != static_cast<ssize_t>(bytes.size())) throw std::runtime_error("sendto failed");
  }

 private:
  Descriptor socket_;
  sockaddr_in group_{};
};

/// The next delivery, waited for up to ten seconds.
inline std::optional<Reception> receive_soon(Bus& bus) {
  for (int i = 0; i < 100; ++i) {
    if (const auto reception = bus.receive(kSecond / 10)) return reception;
  }
  return {};
}

}  // namespace gyrotwin
