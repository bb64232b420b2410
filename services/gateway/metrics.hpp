// What the rig's daemons and the gateway count, as Prometheus reads it. Pure.
#pragma once

#include <cstdint>
#include <string>

#include "services/gateway/gateway.hpp"

namespace gyrotwin {

/// What the server itself counts, since its start.
struct ServerCounters {
  std::int64_t connections = 0;  ///< now
  std::int64_t accepted = 0;
  std::int64_t refused_busy = 0;       ///< too many connections
  std::int64_t refused_access = 0;     ///< no right to what was asked for
  std::int64_t refused_malformed = 0;  ///< no HTTP, or too long
};

/// The text of /metrics, format 0.0.4.
/// @param heard_ago_s by channel: since its last STATUS [s]; < 0: never
std::string metrics_text(const Gateway& gateway, const ServerCounters& server,
                         const BusCounters& bus);

}  // namespace gyrotwin
