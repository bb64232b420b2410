// A flood of valid messages for recorders: signed LIVE/STATE in bursts a millisecond apart.
//   log_sender RATE SECONDS [RIG]    prints how many it has sent, and how many a second
// At SCHED_FIFO where that is granted, as the owners of rigs are: the recorder gets what they
// leave. Before them a second of COMMAND, which nobody counts: recorders that have just begun to
// listen.
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "services/runtime/error.hpp"
#include "services/runtime/rig_bus.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kBurst{1};
/// A sender that was paused for longer does not catch up with one long burst.
constexpr std::chrono::milliseconds kCatchUp{5};

/// Calls `burst` every millisecond until it returns false.
template <class Burst>
void pace(Burst&& burst) {
  auto deadline = Clock::now();
  while (burst()) {
    deadline += kBurst;
    const auto now = Clock::now();
    if (now > deadline + kCatchUp) deadline = now;
    std::this_thread::sleep_until(deadline);
  }
}

int flood(const std::string& rig_name, int rate, double seconds) {
  const sched_param priority{.sched_priority = 80};
  ::sched_setscheduler(0, SCHED_FIFO, &priority);  // else as everybody
  const Rig rig = load_rig(rig_name);
  Bus bus(bus_config(rig, header_t::SIMULATION));
  Stamp stamp{.epoch = random_id()};

  auto command = distinct<command_t>();
  int prelude = 1000;
  pace([&] {
    bus.send(Channel::kCommand, command, stamp);
    ++stamp.sequence;
    return --prelude > 0;
  });

  auto state = distinct<state_t>();
  const auto total = static_cast<std::int64_t>(rate * seconds);
  std::int64_t sent = 0, burst = 0;
  stamp.sequence = 0;
  const auto begin = Clock::now();
  pace([&] {
    for (const std::int64_t due = std::min(total, rate * ++burst / 1000); sent < due; ++sent) {
      bus.send(Channel::kState, state, stamp);
      ++stamp.sequence;
    }
    return sent < total;
  });
  const std::chrono::duration<double> took = Clock::now() - begin;
  std::printf("%lld %.0f\n", static_cast<long long>(sent - bus.counters().send_failed),
              static_cast<double>(sent) / took.count());
  return 0;
}

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  const int rate = argc > 2 ? std::atoi(argv[1]) : 0;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 0.0;
  if (rate <= 0 || seconds <= 0.0) {
    std::fprintf(stderr, "usage: %s RATE SECONDS [RIG]\n", argv[0]);
    return 2;
  }
  try {
    return gyrotwin::flood(argc > 3 ? argv[3] : "prototype_b", rate, seconds);
  } catch (const gyrotwin::Error& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 2;
  }
}
