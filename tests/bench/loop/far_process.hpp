// The controller's end of a subject as a process.
#pragma once

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/bench/loop/trip.hpp"

namespace gyrotwin::bench {

/// How a process runs: on which processor, at which SCHED_FIFO priority (0: none).
struct Placement {
  int processor;
  int priority;

  /// For the calling thread and those it starts. @return 0, or why the priority is refused (errno)
  int take() const {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(processor), &set);
    sched_setaffinity(0, sizeof set, &set);
    if (priority == 0) return 0;
    const sched_param parameters{.sched_priority = priority};
    return sched_setscheduler(0, SCHED_FIFO, &parameters) == 0 ? 0 : errno;
  }
};

/// Answers until it is destroyed.
class FarProcess {
 public:
  FarProcess(const Subject& subject, const Placement& placement) : pid_(fork()) {
    if (pid_ < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
    if (pid_ == 0) answer_for_ever(subject, placement);
  }
  ~FarProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  FarProcess(const FarProcess&) = delete;
  FarProcess& operator=(const FarProcess&) = delete;

  pid_t pid() const { return pid_; }

 private:
  [[noreturn]] static void answer_for_ever(const Subject& subject, const Placement& placement) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    placement.take();
    try {
      const auto far = subject.far();
      while (true) far->answer();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
    _exit(2);
  }

  pid_t pid_;
};

/// How often the threads of a process have given up the processor or lost it.
inline std::int64_t context_switches(pid_t process) {
  std::int64_t total = 0;
  const std::string tasks = "/proc/" + std::to_string(process) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks)) {
    std::ifstream status(task.path() / "status");
    for (std::string word; status >> word;) {
      std::int64_t count = 0;
      if (word.ends_with("voluntary_ctxt_switches:") && status >> count) total += count;
    }
  }
  return total;
}

}  // namespace gyrotwin::bench
