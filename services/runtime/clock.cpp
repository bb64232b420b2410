#include "services/runtime/clock.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

/// Tells the processor that this is a wait: the core's other thread may have its units.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__) || defined(__arm__)
  __asm__ __volatile__("yield");
#endif
}

}  // namespace

void Clock::spin_until(std::int64_t deadline_ns) noexcept {
  while (now_ns() < deadline_ns) relax();
}

std::int64_t MonotonicClock::now_ns() const noexcept { return monotonic_ns(); }

void MonotonicClock::sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec deadline{.tv_sec = deadline_ns / kSecond, .tv_nsec = deadline_ns % kSecond};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace gyrotwin
