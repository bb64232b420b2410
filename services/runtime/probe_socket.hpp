// The socket that `gyrotwin netcheck` measures with: opened like a bus's, and curious about how
// each datagram came.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "services/runtime/bus.hpp"
#include "services/runtime/probe.hpp"

namespace gyrotwin::netcheck {

/// Counts since the socket was opened; as in BusCounters.
struct ProbeCounters : Refusals {
  std::int64_t kernel_dropped = 0, send_failed = 0;
};

/// A probe of this rig that is authentic, and how it came.
struct Arrival {
  Probe probe;
  sockaddr_in from{};
  std::int64_t received_ns = 0;  ///< when the kernel had it: wall clock, since 1970 [ns]
  int ttl = 0;                   ///< with which it arrived
  int interface = 0;             ///< index of the one it came in on
};

/// "198.51.100.1".
std::string address_text(const sockaddr_in& address);

/// Name of the interface with this index; empty when there is none.
std::string interface_name(int index);

/// Not thread-safe. Neither blocks nor allocates once open.
class ProbeSocket {
 public:
  /// @param config the rig's, with the probes' port
  /// @throws Error as a Bus does
  explicit ProbeSocket(const BusConfig& config);
  ProbeSocket(const ProbeSocket&) = delete;
  ProbeSocket& operator=(const ProbeSocket&) = delete;

  /// Next probe of somebody else; everything else is dropped and counted. Empty when nothing more
  /// waits, or when 256 datagrams were read since the last empty result.
  std::optional<Arrival> receive() noexcept;
  /// Sleeps until a datagram may wait or `timeout_ns` have passed. @return whether one may wait.
  bool wait(std::int64_t timeout_ns) noexcept;
  void send(const Probe& probe) noexcept;

  /// Asks the kernel what it has dropped.
  const ProbeCounters& counters() noexcept;
  /// The address that this end speaks from.
  const sockaddr_in& own_address() const noexcept { return sockets_.own_address; }
  /// Receive buffer that the kernel granted [bytes, as it counts them].
  int granted_buffer() const noexcept { return granted_; }
  /// Largest IP packet of the interface [bytes].
  int mtu() const noexcept { return mtu_; }

 private:
  std::optional<std::size_t> read(Arrival& arrival) noexcept;
  void take_note(struct msghdr& message, Arrival& arrival) noexcept;

  ProbeFormat format_;
  MulticastSockets sockets_;
  int granted_ = 0;
  int mtu_ = 0;
  Frame outgoing_{};
  std::array<std::uint8_t, kMaxDatagram + 1> incoming_{};
  int burst_ = 0;  // datagrams read since the last empty result
  ProbeCounters counters_;
};

}  // namespace gyrotwin::netcheck
