// gyrotwin VERB: runs gyrotwin-VERB, found beside this program or else in PATH.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "clients/gyrotwin/verbs.hpp"

namespace {

constexpr int kUsage = 2;

/// Returns only when neither place has the program.
void become(const std::string& verb, char** argv) {
  std::string program = "gyrotwin-" + verb;
  std::error_code none;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", none);
  const std::string beside = (self.parent_path() / program).string();
  argv[0] = program.data();  // the name that ps shows
  execv(beside.c_str(), argv);
  if (errno == ENOENT) execvp(program.c_str(), argv);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "--help";
  if (verb == "--help" || verb == "-h" || verb == "help") {
    std::fputs(gyrotwin::front_page().c_str(), stdout);
    return 0;
  }
  if (verb == "--version") {
    std::puts("gyrotwin " GYROTWIN_VERSION);
    return 0;
  }
  if (verb == "--print-manual") {
    std::fputs(gyrotwin::front_manual().c_str(), stdout);
    return 0;
  }
  if (verb == "--print-words") {
    std::fputs(gyrotwin::front_words().c_str(), stdout);
    return 0;
  }
  // A verb is a name; a path would run what is no part of this.
  if (verb.find('/') == std::string::npos) {
    become(verb, argv + 1);
    if (errno != ENOENT) {
      std::fprintf(stderr, "gyrotwin: error: gyrotwin-%s cannot be run: %s\n", verb.c_str(),
                   std::strerror(errno));
      return kUsage;
    }
  }
  std::fprintf(stderr, "gyrotwin: error: %s\n", gyrotwin::unknown_verb(verb).c_str());
  return kUsage;
}
