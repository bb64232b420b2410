// The bus of a rig, and what a daemon says of itself on it.
#pragma once

#include "services/runtime/bus.hpp"
#include "services/runtime/pacer.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// How to open the bus of a rig; reads the rig's key where it signs.
/// @param source header_t's constant for this program
/// @throws Error naming the key file and how to make one
BusConfig bus_config(const Rig& rig, std::int32_t source);

/// "this host only (lo, 239.255.71.2:7672)" or "this subnet (...)".
std::string reach(const Rig& rig);

/// Who runs this program; asked of the system once.
struct Identity {
  Identity() noexcept;
  std::int32_t pid;
  char host[32] = {};  ///< cut to fit, with a NUL at the end
};

/// Identity and bus counters.
void fill_process(status_t& status, const Identity& identity, const BusCounters& counters) noexcept;
/// Overruns and the loop's distributions.
void fill_loop(status_t& status, Pacer& pacer) noexcept;

}  // namespace gyrotwin
