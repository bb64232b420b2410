#include "services/runtime/clock.hpp"

#include <ctime>

namespace gyrotwin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

}  // namespace

std::int64_t MonotonicClock::now_ns() const noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

void MonotonicClock::sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec deadline{.tv_sec = deadline_ns / kSecond, .tv_nsec = deadline_ns % kSecond};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
}

}  // namespace gyrotwin
