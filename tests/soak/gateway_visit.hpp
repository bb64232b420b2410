// Visits to a gateway that end as visits do: some politely, some not.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <cstdint>
#include <string>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin::support {

/// One connection to a gateway on this host.
class GatewayVisit {
 public:
  explicit GatewayVisit(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience{.tv_sec = 30, .tv_usec = 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ =
        ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    host_ = "localhost:" + std::to_string(port);
  }

  /// @return all of the answer; empty: none
  std::string get(const std::string& path) {
    say("GET " + path + " HTTP/1.1\r\nHost: " + host_ + "\r\nConnection: close\r\n\r\n");
    std::string answer;
    while (const std::size_t more = hear(answer, answer.size() + 1)) (void)more;
    return answer;
  }

  /// Becomes a Foxglove client, subscribes to STATE, hears so much and goes without a word.
  /// @return whether that much came
  bool listen(std::size_t bytes) {
    say("GET / HTTP/1.1\r\nHost: " + host_ +
        "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n");
    std::string heard;
    if (hear(heard, 12) == 0 || !heard.starts_with("HTTP/1.1 101")) return false;
    const std::string wish = R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":0}]})";
    // A text frame, masked with zeros.
    say(std::string{'\x81', static_cast<char>(0x80 | wish.size())} + std::string(4, '\0') + wish);
    return hear(heard, bytes) > 0;
  }

 private:
  void say(const std::string& text) const {
    if (connected_) (void)::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }

  /// Until `heard` has so many bytes. @return how many came; 0: it ended before
  std::size_t hear(std::string& heard, std::size_t size) const {
    const std::size_t before = heard.size();
    while (heard.size() < size) {
      char some[4096];
      const ssize_t came = ::recv(socket_.get(), some, sizeof some, 0);
      if (came <= 0) return 0;
      heard.append(some, static_cast<std::size_t>(came));
    }
    return heard.size() - before;
  }

  Descriptor socket_;
  bool connected_ = false;
  std::string host_;
};

}  // namespace gyrotwin::support
