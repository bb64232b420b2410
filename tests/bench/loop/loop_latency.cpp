// The loop as shipped: how long after a STATE its COMMAND is sent, and after how long it acts, of a
// rig that runs on this host. By the stamps of the senders, which share one clock: README.md.
//   build/release/bin/loop_latency RIG [SECONDS=10]
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "services/runtime/clock.hpp"
#include "services/runtime/rig_bus.hpp"
#include "tests/bench/figure.hpp"

namespace gyrotwin {
namespace {

/// The stamp of the newest STATE of each of the last ticks.
class Stamps {
 public:
  void note(std::int64_t tick, std::int64_t stamp) { ring_[slot(tick)] = {tick, stamp}; }
  /// 0: not known.
  std::int64_t of(std::int64_t tick) const {
    const Entry& entry = ring_[slot(tick)];
    return entry.tick == tick ? entry.stamp : 0;
  }

 private:
  struct Entry {
    std::int64_t tick = -1, stamp = 0;
  };
  static std::size_t slot(std::int64_t tick) { return static_cast<std::size_t>(tick) % 64; }
  std::array<Entry, 64> ring_{};
};

int run(const std::string& name, int seconds) {
  const Rig rig = load_rig(name);
  Bus bus(bus_config(rig, header_t::OPERATOR));
  MonotonicClock clock;
  Stamps states, commands;
  std::vector<std::int64_t> answered, applied;
  std::int64_t asked = 0;
  const std::int64_t end = clock.now_ns() + std::int64_t{1'000'000'000} * seconds;
  const int acts_after = 1 + rig.loop.command_delay_ticks;
  while (clock.now_ns() < end) {
    bus.wait(100'000'000);
    while (const auto reception = bus.receive()) {
      if (reception->channel == Channel::kCommand) {
        command_t command;
        Bus::decode(*reception, command);
        commands.note(command.for_tick, command.header.sender_mono_ns);
        const std::int64_t state = states.of(command.for_tick);
        if (state != 0) answered.push_back(command.header.sender_mono_ns - state);
      } else if (reception->channel == Channel::kState) {
        state_t state;
        Bus::decode(*reception, state);
        const std::int64_t tick = state.header.tick, now = state.header.sender_mono_ns;
        if (state.mode != status_t::MODE_RUNNING || reception->repeat) continue;
        states.note(tick, now);
        const std::int64_t answers = tick - acts_after;
        if (states.of(answers) == 0) continue;
        ++asked;
        // Sent before the owner began the tick in which it acts, or it came too late for that.
        const std::int64_t began = states.of(answers + 1);
        const std::int64_t sent = commands.of(answers);
        if (sent != 0 && sent < began) applied.push_back(now - states.of(answers));
      }
    }
  }
  if (answered.empty() || applied.empty()) {
    std::fprintf(stderr, "loop_latency: no commands of rig %s are heard; arm it first\n",
                 name.c_str());
    return 2;
  }
  const auto figure = [&rig](const char* what) {
    return bench::Figure{"loop", rig.name + ", " + what, "gyrotwin"};
  };
  figure("answered").print_distribution(answered);
  figure("applied").print_distribution(applied);
  figure("applied").print("in_time", "1",
                          static_cast<double>(applied.size()) / static_cast<double>(asked));
  return 0;
}

}  // namespace
}  // namespace gyrotwin

int main(int argc, char** argv) {
  const int seconds = argc == 3 ? std::atoi(argv[2]) : 10;
  if (argc < 2 || argc > 3 || seconds <= 0) {
    std::fprintf(stderr, "usage: %s RIG [SECONDS=10]\n", argv[0]);
    return 2;
  }
  try {
    return gyrotwin::run(argv[1], seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loop_latency: %s\n", error.what());
    return 2;
  }
}
