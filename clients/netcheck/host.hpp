// What this host grants to whoever runs here.
#pragma once

#include "services/runtime/daemon.hpp"
#include "services/runtime/probe_socket.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::netcheck {

/// @param rights that were asked for, and what came of it
HostFacts host_facts(const ProbeSocket& socket, const Rig& rig, const Rights& rights);

}  // namespace gyrotwin::netcheck
