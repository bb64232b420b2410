// A log as MCAP.
#pragma once

#include <filesystem>

#include "clients/log/log_scan.hpp"

namespace gyrotwin {

/// Writes one MCAP file: topics named as the channels, messages in CDR with ros2msg definitions,
/// log and publish time the time of reception, header.sequence where 32 bits hold it (else 0); the
/// rig file as attachment, who recorded as metadata `gyrotwin`.
/// @param compress its chunks with zstd
/// @throws Error, NotDone
void export_mcap(LogScan& scan, const std::filesystem::path& out, bool overwrite, bool compress);

}  // namespace gyrotwin
