// How late ticks begin at 1 kHz, as a daemon's loop sees it, asleep to the end ("gyrotwin") and
// with the last 200 us spun through ("gyrotwin hybrid"), by turns of 100 ticks.
// wakeup_vs_cyclictest.sh runs cyclictest as well.
#include <sys/resource.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"
#include "tests/bench/figure.hpp"

namespace gyrotwin {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // [ns]
constexpr std::int64_t kSpin = 200'000;      // [ns]
constexpr int kPriority = 80;
constexpr int kSlice = 100;  // ticks

/// Processor time of this thread [ns].
std::int64_t processor_ns() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  const auto ns = [](const timeval& t) { return 1'000'000'000 * t.tv_sec + 1000 * t.tv_usec; };
  return ns(usage.ru_utime) + ns(usage.ru_stime);
}

/// One way of waiting for deadlines.
class Waiter {
 public:
  Waiter(const char* name, std::int64_t spin_ns, std::size_t ticks)
      : figure_{"wakeup", "1000", name}, spin_(spin_ns), late_(0) {
    // Every value is kept: the loop's own histograms round up by as much as the tools differ.
    late_.reserve(ticks);
  }

  void run_slice(Clock& clock) {
    const std::int64_t begin = clock.now_ns(), used = processor_ns();
    Pacer pacer(kPeriod, OverrunPolicy::kSkip, spin_);
    pacer.anchor(begin);
    for (int i = 0; i < kSlice; ++i) {
      const std::int64_t deadline = pacer.deadline();
      clock.sleep_until(pacer.wake());
      clock.spin_until(deadline);
      const std::int64_t now = clock.now_ns();
      late_.push_back(now - deadline);
      pacer.begin(now);
    }
    wall_ += clock.now_ns() - begin;
    used_ += processor_ns() - used;
  }

  void report() {
    figure_.print_distribution(late_);
    figure_.print("cpu_share", "1", static_cast<double>(used_) / static_cast<double>(wall_));
  }

 private:
  bench::Figure figure_;
  std::int64_t spin_;
  std::int64_t wall_ = 0, used_ = 0;
  std::vector<std::int64_t> late_;
};

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  using namespace gyrotwin;
  const int seconds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (seconds <= 0) {
    std::fprintf(stderr, "usage: %s SECONDS\n", argv[0]);
    return 2;
  }
  const int slices = 5 * seconds;  // of each, 0.1 s long
  const auto ticks = static_cast<std::size_t>(slices) * kSlice;
  Waiter plain("gyrotwin", 0, ticks), hybrid("gyrotwin hybrid", kSpin, ticks);
  Daemon daemon("wakeup");
  daemon.become_realtime(kPriority);
  MonotonicClock clock;
  for (int i = 0; i < slices && !daemon.stopping(); ++i) {
    plain.run_slice(clock);
    hybrid.run_slice(clock);
  }
  if (daemon.stopping()) return 2;
  plain.report();
  hybrid.report();
  return 0;
}
