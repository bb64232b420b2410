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

}  // namespace

std::int64_t wall_ns() noexcept { return now_of(CLOCK_REALTIME); }

std::int64_t MonotonicClock::now_ns() const noexcept { return now_of(CLOCK_MONOTONIC); }

void MonotonicClock::sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec deadline{.tv_sec = deadline_ns / kSecond, .tv_nsec = deadline_ns % kSecond};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace gyrotwin
