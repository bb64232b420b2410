#include "clients/log/cat.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "clients/log/log.hpp"
#include "clients/log/log_line.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"

namespace gyrotwin {

int cat(const std::filesystem::path& path, const Selection& selection, bool json) {
  ::signal(SIGPIPE, SIG_IGN);
  Log log(path);
  Picker picker(selection);
  while (const auto event = log.next()) {
    if (!picker.takes(*event)) continue;
    const std::string line =
        (json ? json_line : short_line)(log.catalog(), *event, picker.seconds());
    if (std::puts(line.c_str()) < 0) break;
  }
  if (std::ferror(stdout) != 0 || std::fflush(stdout) != 0) {
    if (errno == EPIPE) return kDone;
    throw NotDone("standard output: " + std::string(std::strerror(errno)));
  }
  if (log.damage().any()) {
    std::fprintf(stderr, "%s is damaged: %s\n", path.c_str(), log.damage_text().c_str());
  }
  picker.require_some();
  return kDone;
}

}  // namespace gyrotwin
