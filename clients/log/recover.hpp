// gyrotwin log recover.
#pragma once

#include <filesystem>

namespace gyrotwin {

/// Copies what is sound in a log into a new one, and tells what is lost. @return exit code
/// @throws Error, NotDone
int recover(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace gyrotwin
