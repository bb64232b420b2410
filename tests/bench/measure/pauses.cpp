// What the machine itself withholds, a virtual one for its host's sake: on each processor a thread,
// above all that is measured there, sleeps from tick to tick. Says "watching", and at SIGTERM the
// share of the ticks that went by without it, where it fared worst.
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <future>
#include <optional>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"

namespace gyrotwin {
namespace {

constexpr int kPriority = 98;

/// @return the share that it missed; empty without the right to SCHED_FIFO
std::optional<double> watch(int processor, std::int64_t period_ns, const std::atomic<bool>& over) {
  cpu_set_t here;
  CPU_ZERO(&here);
  CPU_SET(processor, &here);
  if (sched_setaffinity(0, sizeof here, &here) != 0 ||
      take_realtime(kPriority).priority_error != 0) {
    return std::nullopt;
  }
  MonotonicClock clock;
  Pacer pacer(period_ns, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  double kept = 0.0;
  for (; !over; ++kept) {
    clock.sleep_until(pacer.deadline());
    pacer.begin(clock.now_ns());
  }
  const auto missed = static_cast<double>(pacer.skipped_ticks());
  return missed / (kept + missed);
}

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  using namespace gyrotwin;
  const int rate = argc == 2 ? std::atoi(argv[1]) : 0;
  if (rate <= 0) {
    std::fprintf(stderr, "usage: %s HZ\n", argv[0]);
    return 2;
  }
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGINT);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) {
    std::perror("pauses");
    return 2;
  }

  std::atomic<bool> over{false};
  std::vector<std::future<std::optional<double>>> watchers;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (!CPU_ISSET(i, &allowed)) continue;
    watchers.push_back(
        std::async(std::launch::async, watch, i, 1'000'000'000 / rate, std::cref(over)));
  }
  std::puts("watching");
  std::fflush(stdout);
  int signal = 0;
  sigwait(&ends, &signal);
  over = true;

  double worst = 0.0;
  for (auto& watcher : watchers) {
    const std::optional<double> missed = watcher.get();
    if (!missed) {
      std::fputs("pauses: no right to SCHED_FIFO: what the machine withholds is not known\n",
                 stderr);
      return 2;
    }
    worst = std::max(worst, *missed);
  }
  std::printf("%.9f\n", worst);
  return 0;
}
