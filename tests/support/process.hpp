// A program as a child process, its output in a file.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace gyrotwin::support {

/// Killed and reaped at the end of its life, if it still runs then.
class Process {
 public:
  /// @param words program and arguments; stdout and stderr go to `output`
  Process(const std::vector<std::string>& words, std::filesystem::path output);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  bool running();
  /// Exit code, or 128 + signal; kills what has not ended after `limit_s`, which gives 137.
  int wait(double limit_s = 60.0);
  /// What it has printed so far.
  std::string output() const;
  pid_t pid() const { return pid_; }

 private:
  std::filesystem::path output_;
  pid_t pid_ = -1;
  int status_ = -1;
};

}  // namespace gyrotwin::support
