// What a machine withholds from everybody, a virtual one for its host's sake: on each processor a
// thread, above all that is measured there, sleeps from tick to tick. Says "watching", and at
// SIGTERM the share of their ticks that went by without them.
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <latch>
#include <thread>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"

namespace gyrotwin {
namespace {

constexpr int kPriority = 98;

struct Watch {
  std::int64_t period;  // [ns]
  std::latch begun;
  std::atomic<bool> over{false}, refused{false};
  std::atomic<std::int64_t> kept{0}, missed{0};  // ticks
};

void watch_on(int processor, Watch& watch) {
  cpu_set_t here;
  CPU_ZERO(&here);
  CPU_SET(processor, &here);
  if (sched_setaffinity(0, sizeof here, &here) != 0 ||
      take_realtime(kPriority).priority_error != 0) {
    watch.refused = true;
  }
  watch.begun.count_down();
  MonotonicClock clock;
  Pacer pacer(watch.period, OverrunPolicy::kSkip);
  pacer.anchor(clock.now_ns());
  std::int64_t kept = 0;
  do {
    clock.sleep_until(pacer.deadline());
    pacer.begin(clock.now_ns());
    ++kept;
  } while (!watch.over);
  watch.kept += kept;
  watch.missed += pacer.skipped_ticks();
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

  Watch watch{.period = 1'000'000'000 / rate, .begun = std::latch(CPU_COUNT(&allowed))};
  std::vector<std::jthread> threads;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &allowed)) threads.emplace_back(watch_on, i, std::ref(watch));
  }
  watch.begun.wait();
  if (watch.refused) {
    std::fputs("pauses: no right to SCHED_FIFO: what the machine withholds is not known\n", stderr);
  } else {
    std::puts("watching");
    std::fflush(stdout);
    int signal = 0;
    sigwait(&ends, &signal);
  }
  watch.over = true;
  threads.clear();
  if (watch.refused) return 2;
  const auto missed = static_cast<double>(watch.missed);
  std::printf("%.9f\n", missed / (static_cast<double>(watch.kept) + missed));
  return 0;
}
