// What surrounds a daemon's tick thread: rights, signals, log.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace gyrotwin {

/// A line for the log, made on the tick thread without allocating.
enum class LogLevel : std::uint8_t { kInfo, kWarning, kError };

/// Owns everything beside the tick thread of one daemon. To be made first in main(), on the thread
/// that will tick: blocks SIGINT and SIGTERM for all threads, starts the housekeeping thread (normal
/// priority) that waits for these signals and writes the log.
class Daemon {
 public:
  /// @param name program name, stands in every log line
  explicit Daemon(std::string name);
  /// Writes what is left in the log ring and stops the housekeeping thread.
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// SCHED_FIFO at `priority` for the calling thread and mlockall with a touched stack, as far as
  /// permitted; otherwise a warning that says what to grant. Sets RLIMIT_RTTIME as a watchdog.
  void become_realtime(int priority);

  /// A termination signal has come. Cheap; for every tick.
  bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }
  /// As if a signal had come.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  /// Queues a line (cut at 240 characters); never blocks or allocates. A full ring drops the line and
  /// the loss is logged. Formatted with fmt into a buffer on the stack.
  template <class... Args>
  void log(LogLevel level, std::string_view format, const Args&... args) noexcept;

 private:
  std::atomic<bool> stop_{false};
};

}  // namespace gyrotwin
