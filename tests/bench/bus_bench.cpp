// What the bus costs: one message out, one message in. The way there and back, beside other
// middleware, is loop_bench's.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "services/runtime/bus.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

BusConfig config(bool with_key) {
  return test_config(with_key ? std::optional(test_key()) : std::nullopt);
}

/// Encode, sign (argument 1) or not (0), and send one STATE that nobody sleeps for.
void send_state(benchmark::State& run) {
  Bus bus(config(run.range(0) != 0));
  auto state = distinct<state_t>();
  Stamp stamp{.epoch = 1};
  for ([[maybe_unused]] auto _ : run) {
    bus.send(Channel::kState, state, stamp);
    ++stamp.sequence;
  }
  run.counters["send_failed"] = static_cast<double>(bus.counters().send_failed);
}
BENCHMARK(send_state)->ArgName("signed")->Arg(0)->Arg(1);

/// Receive, check and decode one STATE that waits already.
void receive_state(benchmark::State& run) {
  constexpr int kBatch = 100;
  Bus ears(config(run.range(0) != 0));
  Bus mouth(config(run.range(0) != 0));
  auto state = distinct<state_t>();
  Stamp stamp{.epoch = 1};
  while (run.KeepRunningBatch(kBatch)) {
    run.PauseTiming();
    while (ears.receive()) {
    }
    for (int i = 0; i < kBatch; ++i, ++stamp.sequence) mouth.send(Channel::kState, state, stamp);
    run.ResumeTiming();
    for (int i = 0; i < kBatch; ++i) {
      const auto reception = ears.receive();
      if (!reception) return run.SkipWithError("a datagram is missing");
      Bus::decode(*reception, state);
      benchmark::DoNotOptimize(state);
    }
  }
}
BENCHMARK(receive_state)->ArgName("signed")->Arg(0)->Arg(1);

/// The judgement alone: parsing and checking one STATE, no socket.
void parse_state(benchmark::State& run) {
  const BusConfig c = config(run.range(0) != 0);
  const DatagramFormat format(c.prefix, c.rig_id, c.key);
  Frame frame{};
  const std::size_t at = format.begin(frame, Channel::kState, 0);
  std::ranges::copy(distinct_payload(Channel::kState, kTestRig),
                    frame.begin() + static_cast<std::ptrdiff_t>(at));
  const std::span<const std::uint8_t> datagram(frame.data(), at + kWireSize<state_t>);
  format.sign(frame, datagram.size());
  for ([[maybe_unused]] auto _ : run) benchmark::DoNotOptimize(format.parse(datagram));
}
BENCHMARK(parse_state)->ArgName("signed")->Arg(0)->Arg(1);

}  // namespace
}  // namespace gyrotwin
