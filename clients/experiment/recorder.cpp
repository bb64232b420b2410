#include "clients/experiment/recorder.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <thread>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::chrono::milliseconds kLook{20};
constexpr int kLooks = 500;  // until it must have begun

/// Beside this program, as all of them are installed.
std::string program() {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  return (self.parent_path() / "gyrotwin-log").string();
}

[[noreturn]] void become(std::vector<std::string> words) {
  // Of a group of its own: Ctrl-C is for the experiment, which then has the record ended.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGINT);  // an experiment that is killed ends its record
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

Recorder::Recorder(const std::string& file, const std::vector<std::string>& rig_words) {
  if (std::filesystem::exists(file)) throw Error(file + ": exists already; give a new file");
  std::vector<std::string> words{program(), "record", file};
  words.insert(words.end(), rig_words.begin(), rig_words.end());
  process_ = ::fork();
  if (process_ < 0) throw NotDone("no process for the recorder");
  if (process_ == 0) become(words);
  // Its opening events stand in the file once it listens.
  for (int i = 0; i < kLooks; ++i) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    if (!none && size > 0) return;
    require_running();
    std::this_thread::sleep_for(kLook);
  }
  ::kill(process_, SIGKILL);
  wait(true);
  throw NotDone(file + ": the recorder does not begin");
}

Recorder::~Recorder() {
  if (process_ <= 0) return;
  ::kill(process_, SIGINT);
  wait(true);
}

/// @return its exit code; -1 while it runs
int Recorder::wait(bool hang) {
  int status = 0;
  pid_t ended = 0;
  do {
    ended = ::waitpid(process_, &status, hang ? 0 : WNOHANG);
  } while (ended < 0 && errno == EINTR);
  if (ended == 0) return -1;
  process_ = -1;
  return ended > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

void Recorder::require_running() {
  if (process_ > 0 && wait(false) < 0) return;
  throw NotDone("the recorder has ended");
}

void Recorder::stop() {
  if (process_ <= 0) throw NotDone("the recorder has ended");
  ::kill(process_, SIGINT);
  if (wait(true) != 0) throw NotDone("the record is not whole");
}

}  // namespace gyrotwin
