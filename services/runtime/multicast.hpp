// UDP multicast sockets on one named interface, opened and proven to work.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <string>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// One socket to hear the group, one to speak to it; neither blocks when they are opened.
struct MulticastSockets {
  Descriptor receiver;
  Descriptor sender;          ///< connected to the group
  sockaddr_in own_address{};  ///< where the sender's datagrams come from

  /// Whether the sender said it. From an address of its own, as it has on the loopback interface
  /// where the host allows it, the receiver hardly ever hears that.
  bool own(const sockaddr_in& from) const noexcept {
    return from.sin_port == own_address.sin_port &&
           from.sin_addr.s_addr == own_address.sin_addr.s_addr;
  }

  /// Asks the kernel how many datagrams the receiver's buffer had no room for.
  std::int64_t dropped() noexcept;

 private:
  std::uint32_t kernel_drops_ = 0;  // the kernel's own count, which wraps
  std::int64_t dropped_ = 0;
};

/// Opens both, and sends itself one datagram on a port of its own to see that the group works.
/// @param receive_buffer what is asked for [bytes]; the kernel may grant less
/// @throws Error naming what is missing, the key of the rig file that asks for it, and the fix
MulticastSockets open_multicast(const std::string& group, int port, const std::string& interface,
                                int ttl, int receive_buffer);

}  // namespace gyrotwin
