// How late ticks begin at 1 kHz: a daemon's loop asleep to the end ("gyrotwin") and with the last
// 200 us spun through ("gyrotwin hybrid") beside cyclictest (package rt-tests) with the same
// period and priority, by turns.
#include <sys/resource.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
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
constexpr int kSlice = 100;  // ticks of ours
constexpr int kTurn = 500;   // ticks of each in a turn

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

/// A turn of cyclictest, with the processors' sleep states as a daemon has them; rows of zeros are
/// left out. @return how late it was [ns]; what is later than a millisecond is known by its latest
/// alone. Nothing where it is missing, or may not be realtime.
std::vector<std::int64_t> run_cyclictest() {
  const std::string command =
      "cyclictest --quiet --mlockall --laptop --nsecs --histogram=1000000"
      " --priority=" +
      std::to_string(kPriority) + " --interval=" + std::to_string(kPeriod / 1000) +
      " --loops=" + std::to_string(kTurn) + " 2>/dev/null | grep -v ' 000000$'";
  FILE* output = ::popen(command.c_str(), "r");
  if (output == nullptr) return {};
  std::vector<std::int64_t> late;
  std::array<char, 256> line;
  while (std::fgets(line.data(), line.size(), output) != nullptr) {
    long ns = 0, count = 0;
    if (std::sscanf(line.data(), "%ld %ld", &ns, &count) == 2) {
      late.insert(late.end(), static_cast<std::size_t>(count), ns);
    } else if (std::sscanf(line.data(), "# Max Latencies: %ld", &ns) == 1) {
      if (late.size() < kTurn) late.resize(kTurn, 1'000'000);
      late.back() = ns;
    }
  }
  return ::pclose(output) == 0 ? late : std::vector<std::int64_t>();
}

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  using namespace gyrotwin;
  const int seconds = argc == 2 ? std::atoi(argv[1]) : 0;
  if (seconds <= 0) {
    std::fprintf(stderr, "usage: %s SECONDS  (of each)\n", argv[0]);
    return 2;
  }
  const int turns = seconds * 1000 / kTurn;
  const auto ticks = static_cast<std::size_t>(turns) * kTurn;
  Waiter plain("gyrotwin", 0, ticks), hybrid("gyrotwin hybrid", kSpin, ticks);
  std::vector<std::int64_t> peer;
  Daemon daemon("wakeup");
  daemon.become_realtime(kPriority);
  MonotonicClock clock;
  for (int turn = 0; turn < turns && !daemon.stopping(); ++turn) {
    for (int i = 0; i < kTurn / kSlice; ++i) {
      plain.run_slice(clock);
      hybrid.run_slice(clock);
    }
    const std::vector<std::int64_t> late = run_cyclictest();
    peer.insert(peer.end(), late.begin(), late.end());
  }
  if (daemon.stopping()) return 2;
  plain.report();
  hybrid.report();
  if (peer.empty()) {
    std::fprintf(stderr,
                 "wakeup: no word from cyclictest: it needs rt-tests installed, and SCHED_FIFO\n");
  } else {
    bench::Figure{"wakeup", "1000", "cyclictest"}.print_distribution(peer);
  }
  return 0;
}
