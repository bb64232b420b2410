// Lines for systemd's journal.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace gyrotwin {

/// Standard error is the journal's own stream, which adds time and program to a line by itself, and
/// takes a `<N>` in front of it for its priority: `<3>` error, `<4>` warning, `<6>` information.
inline bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat own {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &own) == 0 &&
         std::to_string(own.st_dev) + ':' + std::to_string(own.st_ino) == stream;
}

}  // namespace gyrotwin
