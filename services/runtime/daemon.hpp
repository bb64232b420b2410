// What surrounds a daemon's tick thread: rights, signals, log, service manager.
#pragma once

#include <spdlog/fmt/fmt.h>
#include <sys/types.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "services/runtime/service_manager.hpp"
#include "services/runtime/spsc_ring.hpp"

namespace spdlog {
class logger;
}

namespace gyrotwin {

/// How grave a line of the log is.
enum class LogLevel : std::uint8_t { kInfo, kWarning, kError };

/// What came of asking for a realtime priority and for locked memory: 0 when granted, else errno.
struct Rights {
  int priority_error = 0;
  int memory_error = 0;
  bool granted() const noexcept { return priority_error == 0 && memory_error == 0; }
};

/// SCHED_FIFO at `priority` (1 to 99) for the calling thread and mlockall with a touched stack, as
/// far as permitted. RLIMIT_RTTIME then sends SIGXCPU to a thread that works for 0.2 s without a
/// sleep.
Rights take_realtime(int priority);

/// Owns everything beside the tick thread of one daemon. To be made first in main(), on the thread
/// that will tick: blocks SIGINT and SIGTERM for all threads, starts the housekeeping thread
/// (normal priority) that waits for these signals, writes the log and keeps systemd informed.
class Daemon {
 public:
  static constexpr std::size_t kLogText = 240;   ///< characters of a line that are kept
  static constexpr std::size_t kLogLines = 256;  ///< lines that may wait to be written

  /// @param name program name, stands in every log line
  explicit Daemon(std::string name);
  /// Writes what is left in the log ring and stops the housekeeping thread.
  ~Daemon() = default;
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// take_realtime() for the thread that ticks, and a warning that says what to grant where it was
  /// refused. Best after everything is allocated. A thread that works for 0.2 s without a sleep
  /// loses the priority, and the log says so.
  void become_realtime(int priority);
  /// The same without the warning.
  Rights ask_realtime(int priority);

  /// For the head of the tick thread's loop: notes that it has come round once more. The first
  /// round means that the daemon is up; while none follows, systemd's watchdog is not fed. A loop
  /// that is behind, and has not slept for 50 ms, sleeps for a moment here and keeps its priority.
  /// @return whether the loop shall go on
  bool next_round() noexcept;

  /// A termination signal has come.
  bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }
  /// As if a signal had come.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  /// Queues a line (cut at 240 characters); never blocks or allocates. For the thread that made the
  /// daemon alone. A full ring drops the line and the loss is logged. Formatted with fmt into a
  /// buffer on the stack; where that throws, the line is the bare format.
  template <class... Args>
  void log(LogLevel level, fmt::format_string<const Args&...> format,
           const Args&... args) noexcept {
    queue(level, format, fmt::make_format_args(args...));
  }

  /// How the daemon is, for `systemctl status`; to be said again and again, since what finds no
  /// room is dropped. As log() else; does nothing where no manager listens.
  template <class... Args>
  void show(fmt::format_string<const Args&...> format, const Args&... args) noexcept {
    if (manager_.listens()) queue_status(format, fmt::make_format_args(args...));
  }

 private:
  struct Line {
    std::chrono::system_clock::time_point time;
    LogLevel level;
    std::uint8_t length;
    std::array<char, kLogText> text;

    void write(fmt::string_view format, fmt::format_args args) noexcept;
    std::string_view view() const { return {text.data(), length}; }
  };

  void draw_breath(std::int64_t now_ns) noexcept;
  void queue(LogLevel level, fmt::string_view format, fmt::format_args args) noexcept;
  void queue_status(fmt::string_view format, fmt::format_args args) noexcept;
  void inform_manager();
  void housekeep(const std::stop_token& closing, const std::string& name);
  void await_signal(spdlog::logger& logger);
  void drain(spdlog::logger& logger, std::chrono::milliseconds patience);

  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> rounds_{0};
  std::int64_t breath_ns_ = 0;  ///< when the tick thread was last asked whether it sleeps
  long sleeps_ = 0;             ///< of the tick thread, at that time
  ServiceManager manager_;      // the housekeeping thread's; its listens() is everybody's
  SpscRing<Line, 4> statuses_;
  SpscRing<Line, kLogLines> lines_;
  std::atomic<std::int64_t> lost_lines_{0};
  std::atomic<pid_t> realtime_thread_{0};
  std::jthread housekeeper_;  // last: it uses all the others, and ends first
};

}  // namespace gyrotwin
