// An umbrella platform on another mount than its rig file says.
#pragma once

#include <string_view>

#include "services/model/umbrella.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The rig on another mount. That may have other coordinates: the initial state is carried over as
/// what can be seen of it, so that the disc starts as it sat.
/// @pre an umbrella platform
Rig with_mount(Rig rig, model::Mount mount);

/// An umbrella platform on mount `level`.
bool held_level(const Rig& rig);

/// What that leaves out, the beginning of a sentence.
inline constexpr std::string_view kHeldLevel =
    "mount level is an idealisation: something outside held the disc level";

}  // namespace gyrotwin
