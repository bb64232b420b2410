// How late ticks begin at 1 kHz, as a daemon's loop sees it. wakeup_vs_cyclictest.sh compares.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"

int main(int argc, char** argv) {
  using namespace gyrotwin;
  constexpr std::int64_t kPeriod = 1'000'000;  // [ns]
  constexpr int kPriority = 80;
  const int seconds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (seconds <= 0) {
    std::fprintf(stderr, "usage: %s SECONDS\n", argv[0]);
    return 2;
  }

  // Every value is kept: the loop's own histograms round up by as much as the tools differ.
  std::vector<std::int64_t> lateness(static_cast<std::size_t>(seconds) * 1000);
  Daemon daemon("wakeup");
  daemon.become_realtime(kPriority);

  MonotonicClock clock;
  Pacer pacer(kPeriod, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  for (std::int64_t& late : lateness) {
    if (daemon.stopping()) return 1;
    const std::int64_t deadline = pacer.deadline();
    clock.sleep_until(deadline);
    const std::int64_t now = clock.now_ns();
    late = now - deadline;
    pacer.begin(now);
  }

  std::sort(lateness.begin(), lateness.end());
  const auto percentile_us = [&lateness](double percent) {
    const double rank = std::ceil(1e-2 * percent * static_cast<double>(lateness.size()));
    return 1e-3 * static_cast<double>(lateness[static_cast<std::size_t>(rank) - 1]);
  };
  std::printf("p50 %.1f p99 %.1f p99.9 %.1f max %.1f us, %lld overruns\n", percentile_us(50),
              percentile_us(99), percentile_us(99.9), percentile_us(100),
              static_cast<long long>(pacer.overruns()));
  return 0;
}
