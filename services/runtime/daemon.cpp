#include "services/runtime/daemon.hpp"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <system_error>
#include <utility>

#include "services/runtime/clock.hpp"
#include "services/runtime/journal.hpp"

namespace gyrotwin {
namespace {

constexpr timespec kHousekeepingPeriod{.tv_sec = 0, .tv_nsec = 20'000'000};
// How long the last lines wait for a reader of stderr that has stopped reading.
constexpr std::chrono::milliseconds kLastPatience{200};

// Work without a sleep in realtime [us]: the soft limit is answered by the housekeeping thread, the
// hard one by the kernel's SIGKILL. On a single core, where realtime throttling alone lets others
// run, the answer may take 1.9 s.
constexpr rlim_t kRealtimeSoft = 200'000;
constexpr rlim_t kRealtimeHard = 2'000'000;

// How often a loop is asked whether it sleeps, and how long it does where it has not.
constexpr std::int64_t kBreathPeriod = 50'000'000;  // [ns]
constexpr timespec kBreath{.tv_sec = 0, .tv_nsec = 100'000};

constexpr sched_param kNormal{.sched_priority = 0};

constexpr std::size_t kTouchedStack = std::size_t{512} * 1024;  // [byte]

sigset_t signal_set(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

/// A line's priority as the journal reads it: `<4>`.
class PriorityFlag : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& line, const std::tm&,
              spdlog::memory_buf_t& text) override {
    const int priority = line.level >= spdlog::level::err    ? 3
                         : line.level == spdlog::level::warn ? 4
                                                             : 6;
    fmt::format_to(std::back_inserter(text), "<{}>", priority);
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<PriorityFlag>();
  }
};

spdlog::logger make_logger(const std::string& name) {
  spdlog::logger logger(name, std::make_shared<spdlog::sinks::stderr_color_sink_st>());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PriorityFlag>('j');
  formatter->set_pattern(stderr_is_journal() ? "%j%v" : "%Y-%m-%d %H:%M:%S.%e %n %^%l%$: %v");
  logger.set_formatter(std::move(formatter));
  return logger;
}

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      break;
  }
  return spdlog::level::err;
}

// A terminal held with Ctrl-S or a pipe nobody reads would block the write, and with it the
// handling of signals.
bool stderr_takes_a_line(std::chrono::milliseconds patience) {
  pollfd descriptor{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
  return ::poll(&descriptor, 1, static_cast<int>(patience.count())) != 0;
}

// @return 0 or errno
int take_fifo(int priority) {
  rlimit limit{};
  ::getrlimit(RLIMIT_RTTIME, &limit);
  limit.rlim_max = std::min(limit.rlim_max, kRealtimeHard);
  limit.rlim_cur = std::min(limit.rlim_max, kRealtimeSoft);
  ::setrlimit(RLIMIT_RTTIME, &limit);

  // What the hard limit grants, the soft one need not withhold.
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_RTPRIO, &limit);

  const sched_param parameters{.sched_priority = priority};
  return ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0 ? 0 : errno;
}

// @return 0 or errno
int lock_memory() {
  // Under a finite limit a later allocation would fail, not merely stay unlocked. So such a limit
  // is brought down to zero, where only the capability counts.
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? RLIM_INFINITY : 0;
  ::setrlimit(RLIMIT_MEMLOCK, &limit);
  return ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

[[gnu::noinline]] void touch_stack() {
  std::array<char, kTouchedStack> pages;
  for (std::size_t i = 0; i < pages.size(); i += 4096) {
    static_cast<volatile char*>(pages.data())[i] = 0;
  }
}

std::string own_path() {
  std::error_code error;
  const auto path = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? "PROGRAM" : path.string();
}

}  // namespace

Rights take_realtime(int priority) {
  // Without realtime rights the kernel would bundle wake-ups within 50 us.
  ::prctl(PR_SET_TIMERSLACK, 1);
  const Rights rights{.priority_error = take_fifo(priority), .memory_error = lock_memory()};
  touch_stack();
  return rights;
}

Daemon::Daemon(std::string name) {
  // SIGPIPE as well: the reader of the log may go, the plant still needs its owner.
  const sigset_t blocked = signal_set({SIGINT, SIGTERM, SIGXCPU, SIGPIPE});
  ::pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
  housekeeper_ = std::jthread(
      [this, name = std::move(name)](const std::stop_token& closing) { housekeep(closing, name); });
}

Rights Daemon::ask_realtime(int priority) {
  realtime_thread_ = ::gettid();
  return take_realtime(priority);
}

void Daemon::become_realtime(int priority) {
  const Rights rights = ask_realtime(priority);
  if (rights.granted()) return;

  const auto outcome = [](int error) { return error == 0 ? "granted" : std::strerror(error); };
  log(LogLevel::kWarning,
      "ticks may be late under load: realtime priority {}: {}, locked memory: {}; grant both with: "
      "sudo setcap cap_sys_nice,cap_ipc_lock+ep {}",
      priority, outcome(rights.priority_error), outcome(rights.memory_error), own_path());
}

bool Daemon::next_round() noexcept {
  rounds_.store(rounds_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (realtime_thread_ != 0) draw_breath(monotonic_ns());
  return !stopping();
}

void Daemon::draw_breath(std::int64_t now_ns) noexcept {
  if (now_ns - breath_ns_ < kBreathPeriod) return;
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  if (usage.ru_nvcsw == sleeps_) ::nanosleep(&kBreath, nullptr);
  sleeps_ = usage.ru_nvcsw;
  breath_ns_ = now_ns;
}

void Daemon::Line::write(fmt::string_view format, fmt::format_args args) noexcept {
  std::size_t wanted = 0;
  try {
    wanted = fmt::vformat_to_n(text.data(), kLogText, format, args).size;
  } catch (...) {
    wanted = format.size();
    std::copy_n(format.data(), std::min(wanted, kLogText), text.data());
  }
  length = static_cast<std::uint8_t>(std::min(wanted, kLogText));
  // Texts of peers may stand in it.
  std::replace_if(
      text.begin(), text.begin() + length, [](char c) { return (c >= 0 && c < ' ') || c == 127; },
      '?');
}

void Daemon::queue(LogLevel level, fmt::string_view format, fmt::format_args args) noexcept {
  Line line;
  line.time = std::chrono::system_clock::now();
  line.level = level;
  line.write(format, args);
  if (!lines_.push(line)) lost_lines_.fetch_add(1, std::memory_order_relaxed);
}

void Daemon::queue_status(fmt::string_view format, fmt::format_args args) noexcept {
  Line line{};
  line.write(format, args);
  statuses_.push(line);
}

void Daemon::housekeep(const std::stop_token& closing, const std::string& name) {
  // The thread that made the daemon may have been started with a realtime priority.
  ::sched_setscheduler(0, SCHED_OTHER, &kNormal);
  ::pthread_setname_np(::pthread_self(), "housekeeping");

  spdlog::logger logger = make_logger(name);
  while (!closing.stop_requested()) {
    await_signal(logger);
    drain(logger, std::chrono::milliseconds{0});
    inform_manager();
  }
  manager_.stopping();
  drain(logger, kLastPatience);
}

void Daemon::inform_manager() {
  const auto now = std::chrono::steady_clock::now();
  manager_.hear_rounds(rounds_.load(std::memory_order_relaxed), now);
  Line status;
  while (statuses_.pop(status)) manager_.show(status.view(), now);
  if (stopping()) manager_.stopping();
}

void Daemon::await_signal(spdlog::logger& logger) {
  const sigset_t awaited = signal_set({SIGINT, SIGTERM, SIGXCPU});
  const int signal = ::sigtimedwait(&awaited, nullptr, &kHousekeepingPeriod);
  if (signal < 0) return;  // nothing came
  if (signal != SIGXCPU) return stop();
  // Only privilege may take the flag back.
  ::sched_setscheduler(realtime_thread_, SCHED_OTHER | SCHED_RESET_ON_FORK, &kNormal);
  if (stderr_takes_a_line(std::chrono::milliseconds{0})) {
    logger.error("the tick thread has not slept for {} ms and loses its realtime priority",
                 kRealtimeSoft / 1000);
  }
}

void Daemon::drain(spdlog::logger& logger, std::chrono::milliseconds patience) {
  Line line;
  while (stderr_takes_a_line(patience) && lines_.pop(line)) {
    logger.log(line.time, {}, spdlog_level(line.level), line.view());
  }
  if (lost_lines_.load(std::memory_order_relaxed) > 0 && stderr_takes_a_line(patience)) {
    logger.warn("{} log lines lost: they came faster than they could be written",
                lost_lines_.exchange(0, std::memory_order_relaxed));
  }
}

}  // namespace gyrotwin
