#include "services/runtime/clock.hpp"

#include <ctime>

namespace gyrotwin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

std::int64_t now_of(clockid_t clock) noexcept {
  timespec now{};
  ::clock_gettime(clock, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

/// Tells the processor that this is a wait: the core's other thread may have its units.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__) || defined(__arm__)
  __asm__ __volatile__("yield");
#endif
}

}  // namespace

std::int64_t wall_ns() noexcept { return now_of(CLOCK_REALTIME); }

void Clock::spin_until(std::int64_t deadline_ns) noexcept {
  while (now_ns() < deadline_ns) relax();
}

std::int64_t MonotonicClock::now_ns() const noexcept { return now_of(CLOCK_MONOTONIC); }

void MonotonicClock::sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec deadline{.tv_sec = deadline_ns / kSecond, .tv_nsec = deadline_ns % kSecond};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace gyrotwin
