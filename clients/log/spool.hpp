// Between the thread that hears and the thread that writes: neither waits for the other.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>

#include "clients/log/log_file.hpp"

namespace gyrotwin {

/// Events laid out one after another, as many as fit.
class Spool {
 public:
  /// What may wait [byte].
  static constexpr std::size_t kRoom = 256 << 20;
  /// Room that is kept when nothing waits; what a slow disk took beyond it is given back [byte].
  static constexpr std::size_t kCalm = 64 << 10;

  /// @return false, and nothing kept, when it is full
  bool put(const LogEvent& event) {
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.size() + size_in_log(event) > kRoom) return false;
      append_event(waiting_, event);
    }
    arrived_.notify_one();
    return true;
  }

  /// No more will be put.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_one();
  }

  /// Replaces `events` by all that waits, after `patience` at the latest.
  /// @return false when nothing waits and nothing will come
  bool take(LogBytes& events, std::chrono::milliseconds patience) {
    events.clear();
    if (events.capacity() > kCalm) events = LogBytes();
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, patience, [this] { return closed_ || !waiting_.empty(); });
    std::swap(events, waiting_);
    return !events.empty() || !closed_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  LogBytes waiting_;
  bool closed_ = false;
};

}  // namespace gyrotwin
