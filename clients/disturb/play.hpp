// Playing a scenario to a live owner.
#pragma once

#include <cstdint>
#include <vector>

#include "clients/common/asker.hpp"
#include "clients/common/scenario.hpp"

namespace gyrotwin {

/// The tick that a scenario's times count from: 0 while the owner is HELD, so that every run is the
/// same; the next one while it is PAUSED; otherwise 0.2 s of wall time from now, so that all of it
/// is scheduled before any of it begins.
std::int64_t first_tick(const status_t& owner);

/// Has all events scheduled and prints each answer. All or nothing: when one is refused, those
/// before it are cancelled.
/// @throws NotDone naming the refused event and the reason
void play(Asker& asker, const Rig& rig, const std::vector<PlannedEvent>& scenario);

}  // namespace gyrotwin
