// Another mount or track for an umbrella platform than its rig file says.
#pragma once

#include <string>

#include "services/runtime/cli.hpp"

namespace gyrotwin {

/// Overrides the rig's mount and track where they are not empty. Another mount may have other
/// coordinates: the rig's initial state is carried over as what can be seen of it, so that the disc
/// starts as it sat.
/// @throws Error when the rig is wrong or no umbrella platform
void choose_mount(RigOptions& rig_options, const std::string& mount, const std::string& track);

}  // namespace gyrotwin
