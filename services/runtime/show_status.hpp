// A daemon's STATUS for its service manager.
#pragma once

#include "messages/channels.hpp"
#include "services/runtime/daemon.hpp"

namespace gyrotwin {

/// Mode and text of a STATUS that is sent, for `systemctl status`.
void show_status(Daemon& daemon, const status_t& status) noexcept;

}  // namespace gyrotwin
