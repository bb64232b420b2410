// Brings files to the disk while others write to them.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// A thread that waits for the disk, so that nobody else has to.
class Syncer {
 public:
  Syncer() : thread_([this](const std::stop_token& stop) { work(stop); }) {}
  Syncer(const Syncer&) = delete;
  Syncer& operator=(const Syncer&) = delete;

  /// What stands in the file now goes to the disk, soon. Returns at once; the file may be closed.
  void sync(int file);

  /// Waits for all that was asked for.
  /// @throws NotDone when the disk did not take something
  void finish();

 private:
  void work(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any asked_;
  std::vector<Descriptor> files_;
  int error_ = 0;        // first errno
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace gyrotwin
