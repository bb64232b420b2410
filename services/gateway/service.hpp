// The gateway's event loop: bus, clients, timer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/gateway/server.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

struct GatewayOptions {
  Endpoint endpoint;
  std::vector<std::string> origins;  ///< of foreign pages
  bool any_program = false;          ///< programs on other hosts may connect
  std::filesystem::path page, recordings;
  std::vector<std::string> rig_arguments;  ///< `--rig` and `--set` words
  std::string rig_text;                    ///< the rig file in effect
};

/// Runs until the daemon is to stop.
/// @throws Error when the address cannot be listened on or the page cannot be read
void run_gateway(const Rig& rig, const GatewayOptions& options, const Tokens& tokens, Bus& bus,
                 Clock& clock, Daemon& daemon);

/// Where to look: "http://127.0.0.1:8765/?token=...". An address that means every one is told as
/// this host's name.
std::string url(const Endpoint& endpoint, const std::string& token);

}  // namespace gyrotwin
