// HTTP and WebSocket on one port. The only file besides service.cpp that knows Boost's Asio.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "services/gateway/access.hpp"
#include "services/gateway/gateway.hpp"
#include "services/gateway/metrics.hpp"
#include "services/gateway/page.hpp"
#include "services/gateway/recorder.hpp"

namespace boost::asio {
class io_context;
}

namespace gyrotwin {

/// Where to listen.
struct Endpoint {
  std::string address;  ///< numeric
  std::uint16_t port;   ///< 0: any that is free
};

/// "127.0.0.1:8765", "[::1]:8765".
/// @throws Error when it is none
Endpoint parse_endpoint(const std::string& text);
/// As it stands in a URL.
std::string host_of(const Endpoint& endpoint);

class Server {
 public:
  static constexpr int kMostConnections = 64;

  /// What the server is the face of; all outlive it.
  struct Parts {
    Gateway& gateway;
    const Access& access;
    const Page& page;
    Recorder& recorder;
    const BusCounters& bus;
  };

  /// Listens from now on.
  /// @throws Error when the address is taken or not this host's
  Server(boost::asio::io_context& io, const Endpoint& endpoint, const Parts& parts);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Sends what waits in the clients' outboxes.
  void flush();

  Endpoint endpoint() const;  ///< with the port that was found
  /// Why somebody was refused since the last call; empty: nobody was. Programs do not show the
  /// answer that they got.
  std::string take_refusal();
  const ServerCounters& counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gyrotwin
