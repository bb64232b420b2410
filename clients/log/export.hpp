// gyrotwin log export.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "clients/log/selection.hpp"

namespace gyrotwin {

struct ExportOptions {
  std::filesystem::path file, out;
  std::string format;  ///< "csv", "mat", "mcap"; empty: by the ending of `out`
  Selection selection;
  std::int64_t every = 1;  ///< of each channel, take the first of so many messages
  bool force = false;      ///< replace files that are there
  bool compress = true;    ///< where the format knows how
};

/// Turns a log into files that other programs read. Of an export that fails nothing is left.
/// @return exit code @throws Error, NotDone
int export_log(const ExportOptions& options);

}  // namespace gyrotwin
