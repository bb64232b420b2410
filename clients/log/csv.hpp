// A log as comma-separated values.
#pragma once

#include <filesystem>

#include "clients/log/log_scan.hpp"

namespace gyrotwin {

/// Writes one RFC 4180 file a stream, `run.LIVE_STATE.csv` for `run.csv`: a header row, then one
/// row a message. Columns: time_s, received_us, every number and text. Every digit of a number.
/// @return the files
/// @throws Error, NotDone
std::vector<std::filesystem::path> export_csv(LogScan& scan, const std::filesystem::path& out,
                                              bool overwrite);

}  // namespace gyrotwin
