#include "clients/log/listener.hpp"

#include <limits>

#include "services/runtime/clock.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kTurn = 50'000'000;  // [ns]
constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();

std::int64_t wall_clock_us() { return wall_ns() / 1000; }

}  // namespace

BusCounters Listener::counters() {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void Listener::listen(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    tap_.wait(kTurn);
    drain(kForEver);
    keep_counters();
  }
  const std::int64_t end_us = wall_clock_us();
  while (drain(end_us)) {
  }
  keep_counters();
  spool_.close();
}

/// One burst. @return whether more may wait that came before `until_us`
bool Listener::drain(std::int64_t until_us) {
  bool any = false;
  while (const auto heard = tap_.receive()) {
    any = true;
    if (heard->received_us > until_us) return false;
    const LogEvent event{
        .time_us = heard->received_us, .channel = heard->channel, .data = heard->payload};
    if (!spool_.put(event)) overflowed_.fetch_add(1, std::memory_order_relaxed);
  }
  return any;
}

void Listener::keep_counters() {
  const BusCounters& now = tap_.counters();
  const std::lock_guard lock(mutex_);
  counters_ = now;
}

}  // namespace gyrotwin
