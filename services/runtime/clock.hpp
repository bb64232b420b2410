// Time, as daemons see it: passed in, so that tests bring their own.
#pragma once

#include <cstdint>
#include <ctime>

namespace gyrotwin {

inline std::int64_t nanoseconds(const timespec& time) noexcept {
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

/// What a clock of the kernel shows [ns].
inline std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec now{};
  ::clock_gettime(clock, &now);
  return nanoseconds(now);
}

/// Wall clock, since 1970 [ns]: for stamps that others read; it may be set while a program runs.
inline std::int64_t wall_ns() noexcept { return clock_ns(CLOCK_REALTIME); }

/// CLOCK_MONOTONIC [ns]: one for all programs of a host, never set.
inline std::int64_t monotonic_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }

/// Monotonic time in nanoseconds.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() const noexcept = 0;
  /// Returns at or after `deadline_ns`, or early when interrupted by a signal.
  virtual void sleep_until(std::int64_t deadline_ns) noexcept = 0;
  /// Returns at or after `deadline_ns`, and holds the processor until then.
  virtual void spin_until(std::int64_t deadline_ns) noexcept;
};

/// CLOCK_MONOTONIC.
class MonotonicClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override;
  void sleep_until(std::int64_t deadline_ns) noexcept override;
};

/// Time that passes when told to; sleeping moves it to the deadline plus `lateness`, spinning to
/// the deadline.
class FakeClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return now_; }
  void sleep_until(std::int64_t deadline_ns) noexcept override {
    if (deadline_ns > now_) now_ = deadline_ns;
    now_ += lateness;
  }
  void spin_until(std::int64_t deadline_ns) noexcept override {
    if (deadline_ns > now_) now_ = deadline_ns;
  }
  void advance(std::int64_t ns) { now_ += ns; }
  std::int64_t lateness = 0;  ///< [ns]

 private:
  std::int64_t now_ = 0;
};

}  // namespace gyrotwin
