#include "clients/log/export.hpp"

#include <csignal>
#include <cstdio>
#include <vector>

#include "clients/log/csv.hpp"
#include "clients/log/log_scan.hpp"
#include "clients/log/mat.hpp"
#include "clients/log/mcap.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"

namespace gyrotwin {

namespace {

/// What the options or the file's ending say.
std::string format_of(const ExportOptions& options) {
  if (!options.format.empty()) return options.format;
  const std::string ending = options.out.extension().string();
  for (const char* format : {"csv", "mat", "mcap"}) {
    if (ending == '.' + std::string(format)) return format;
  }
  throw Error(options.out.string() +
              ": its ending is none of .csv, .mat, .mcap; give one of them, or --format");
}

}  // namespace

int export_log(const ExportOptions& options) {
  ::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is a full disk like another
  const std::string format = format_of(options);
  LogScan scan(options.file, options.selection, options.every);
  std::vector<std::filesystem::path> files{options.out};
  if (format == "csv") {
    files = export_csv(scan, options.out, options.force);
  } else if (format == "mat") {
    export_mat(scan, options.out, options.force, options.compress);
  } else {
    export_mcap(scan, options.out, options.force, options.compress);
  }
  scan.tell_losses();
  for (const LogStream& stream : scan.streams()) {
    std::printf("%-40s %10lld messages\n", stream.channel.c_str(),
                static_cast<long long>(stream.messages));
  }
  for (const auto& file : files) {
    std::printf("%s: %.3f MB\n", file.c_str(),
                1e-6 * static_cast<double>(std::filesystem::file_size(file)));
  }
  return kDone;
}

}  // namespace gyrotwin
