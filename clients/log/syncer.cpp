#include "clients/log/syncer.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

void Syncer::sync(int file) {
  {
    const std::lock_guard lock(mutex_);
    files_.emplace_back(::dup(file));
  }
  asked_.notify_one();
}

void Syncer::finish() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  if (error_ != 0) {
    throw NotDone("the disk did not keep all that was recorded: " +
                  std::string(std::strerror(error_)));
  }
}

void Syncer::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (asked_.wait(lock, stop, [this] { return !files_.empty(); })) {
    const std::vector<Descriptor> files = std::exchange(files_, {});
    lock.unlock();
    int error = 0;
    for (const Descriptor& file : files) {
      // What cannot be synchronised, a pipe say, is none of the disk's.
      if (::fdatasync(file.get()) != 0 && errno != EINVAL && error == 0) error = errno;
    }
    lock.lock();
    if (error_ == 0) error_ = error;
  }
}

}  // namespace gyrotwin
