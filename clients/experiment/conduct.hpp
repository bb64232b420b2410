// Experiments on whoever owns a rig, over the bus.
#pragma once

#include <functional>
#include <optional>

#include "clients/common/asker.hpp"
#include "clients/experiment/preparation.hpp"

namespace gyrotwin {

/// Where a simulated rig starts. @return empty: where the rig file says
std::optional<request_t> start_of(const ExperimentPlan& plan);

/// Does it, from HELD to SAFE_STOP. However it ends, the drives are off.
/// @param go_on asked at least ten times a second
/// @throws NotDone when the owner refuses, falls silent, or `go_on` says no
void conduct(const ExperimentPlan& plan, const Rig& rig, Asker& asker,
             const std::function<bool()>& go_on);

}  // namespace gyrotwin
