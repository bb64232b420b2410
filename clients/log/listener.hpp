// The thread that hears for a record.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <thread>

#include "clients/log/spool.hpp"
#include "services/runtime/tap.hpp"

namespace gyrotwin {

/// Puts into the spool what a tap hears; closes it at the end.
class Listener {
 public:
  Listener(Tap& tap, Spool& spool)
      : tap_(tap), spool_(spool), thread_([this](const std::stop_token& stop) { listen(stop); }) {}
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Ends once everything is in the spool that had arrived by now. Returns at once.
  void stop() { thread_.request_stop(); }

  /// Of the tap, a little old.
  BusCounters counters();
  /// Heard and left out, for the spool was full.
  std::int64_t overflowed() const { return overflowed_.load(std::memory_order_relaxed); }

 private:
  void listen(const std::stop_token& stop);
  bool drain(std::int64_t until_us);
  void keep_counters();

  Tap& tap_;
  Spool& spool_;
  std::atomic<std::int64_t> overflowed_{0};
  std::mutex mutex_;
  BusCounters counters_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace gyrotwin
