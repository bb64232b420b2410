// What ctl learns by listening alone.
#pragma once

#include <cstdint>

#include "clients/common/asker.hpp"
#include "clients/ctl/balance.hpp"
#include "clients/ctl/report.hpp"
#include "services/runtime/mode.hpp"

namespace gyrotwin {

/// Listens until every peer spoke, a second at the longest.
Sighting sight(const Rig& rig, Asker& asker);

/// Waits until the owner is in a mode.
/// @throws NotDone when that takes longer than `limit_ns` of wall time
void wait_for_mode(Asker& asker, Mode mode, std::int64_t limit_ns);

/// Waits until the owner is HELD, a controller is heard and nothing else is in the way of arming.
/// @throws NotDone when that takes longer than `limit_ns` of wall time
void wait_until_ready(Asker& asker, std::int64_t limit_ns);

/// Waits until `watch` is content.
/// @throws NotDone when that takes longer than `limit_ns` of wall time, or cannot be any more: in
///         SAFE_STOP, FALLEN and FAULT
void wait_for_balance(Asker& asker, BalanceWatch watch, std::int64_t limit_ns);

}  // namespace gyrotwin
