// A log as a MATLAB file.
#pragma once

#include <filesystem>

#include "clients/log/log_scan.hpp"

namespace gyrotwin {

/// Writes a MAT 5 file (MATLAB's v7), which Octave, scipy and MATLAB read: one struct a stream, by
/// its name, of as many rows as there are messages. Fields: time_s, received_us, then every field
/// of the type (`.` is `_`): numbers are doubles, rows x elements, int64 stay int64; texts are a
/// cell column; `units` is a struct of texts with the same names. Reads the log twice; holds what
/// it writes in memory.
/// @throws Error; NotDone, also when a struct is above the format's 2 GB
void export_mat(LogScan& scan, const std::filesystem::path& out, bool overwrite, bool compress);

}  // namespace gyrotwin
