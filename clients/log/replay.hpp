// gyrotwin log replay.
#pragma once

#include <filesystem>

#include "clients/log/selection.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Sends messages of a log on the rig's bus, each byte as recorded, in the recorded order and time.
/// @param speed recorded over wall time
/// @return exit code
/// @throws Error when the log is another rig's; NotDone when an owner of the rig is heard
int replay(const Rig& rig, const std::filesystem::path& path, const Selection& selection,
           double speed);

}  // namespace gyrotwin
