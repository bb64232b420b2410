// gyrotwin log cat.
#pragma once

#include <filesystem>

#include "clients/log/selection.hpp"

namespace gyrotwin {

/// Prints messages of a log, one a line. @return exit code; a reader who goes away ends it well
/// @throws Error, NotDone
int cat(const std::filesystem::path& path, const Selection& selection, bool json);

}  // namespace gyrotwin
