// UDP multicast sockets on one named interface, opened and proven to work.
#pragma once

#include <netinet/in.h>

#include <string>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// One socket to hear the group, one to speak to it; neither blocks.
struct MulticastSockets {
  Descriptor receiver;
  Descriptor sender;        ///< connected to the group
  sockaddr_in own_address;  ///< where the sender's datagrams come from
};

/// Opens both, and sends itself one datagram on a port of its own to see that the group works.
/// @param receive_buffer what is asked for [bytes]; the kernel may grant less
/// @throws Error naming what is missing, the key of the rig file that asks for it, and the fix
MulticastSockets open_multicast(const std::string& group, int port, const std::string& interface,
                                int ttl, int receive_buffer);

}  // namespace gyrotwin
