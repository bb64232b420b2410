// gyrotwin log record.
#pragma once

#include <string>

#include "clients/log/log_series.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/tap.hpp"

namespace gyrotwin {

/// What the command line says.
struct RecordOptions {
  std::string file;  ///< empty: named by rig and time
  Tap::Keep keep = Tap::Keep::kRig;
  LogSeries::Limits limits;
};

/// Records until SIGINT or SIGTERM. @return exit code
/// @param rig_file the rig in effect, as TOML
/// @throws Error, NotDone
int record(const Rig& rig, const std::string& rig_file, const RecordOptions& options);

}  // namespace gyrotwin
