// A mirror on the bus: who is behind tells TWIN/STATE of every tick, and forecasts later.
#include "services/mirror/service.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "services/runtime/text.hpp"
#include "tests/support/mirrored_loop.hpp"
#include "tests/support/raw_peer.hpp"

namespace gyrotwin {
namespace {

struct Bench {
  explicit Bench(const char* host) : owner_host(host) {
    loop.hear();
    tell_status();
    loop.ask(request_t::ARM);
  }

  void tell_status() {
    status_t told{};
    loop.integrator.fill(told);
    set_text(told.host, "{}", owner_host);
    owner.send(Channel::kIntegratorStatus, told,
               {.epoch = loop.integrator.epoch(), .sequence = ++status_sequence});
  }

  /// So many ticks wait on the bus when the mirror looks.
  void round_after(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      loop.tick();
      const header_t& header = loop.sensors.header;
      const Stamp stamp{header.epoch, header.sequence, header.tick, header.sim_time_ns};
      owner.send(Channel::kState, loop.state, stamp);
      owner.send(Channel::kSensors, loop.sensors, stamp);
      owner.send(Channel::kCommand, loop.command, stamp);
    }
    tell_status();
    clock.advance(kSecond);  // STATUS is due
    service.round();
    while (const auto reception = ears.receive()) {
      twin_states += reception->channel == Channel::kTwinState;
      forecasts += reception->channel == Channel::kForecast;
      if (reception->channel == Channel::kMirrorStatus) Bus::decode(*reception, status);
    }
  }
  void rounds(int count, int ticks) {
    for (int i = 0; i < count; ++i) round_after(ticks);
  }

  std::string owner_host;
  std::int64_t status_sequence = 0;
  support::MirroredLoop loop{"double_brennan", {"loop.state=estimate"}};
  BusConfig config = test_config();
  Bus ears{config}, owner{config}, bus{config};
  FakeClock clock;
  Daemon daemon{"test"};
  MirrorService service{loop.rig, bus, clock, daemon};
  int twin_states = 0, forecasts = 0;
  status_t status{};
};

TEST(MirrorService, ForecastsWhileItKeepsUp) {
  Bench bench("elsewhere");
  bench.rounds(1000, 1);
  EXPECT_EQ(bench.twin_states, 1000);
  EXPECT_GE(bench.forecasts, 40);
  EXPECT_EQ(bench.status.overruns, 0);
}

TEST(MirrorService, WhereSensorsWaitForecastingYields) {
  Bench bench("elsewhere");
  bench.rounds(500, 1);
  bench.twin_states = bench.forecasts = 0;
  bench.rounds(20, 25);
  EXPECT_EQ(bench.twin_states, 500) << "of every tick";
  EXPECT_EQ(bench.status.overruns, 480) << "all but the last of each round";
  EXPECT_LE(bench.forecasts, 5) << "of 25";
  bench.twin_states = bench.forecasts = 0;
  bench.rounds(500, 1);
  EXPECT_EQ(bench.twin_states, 500);
  EXPECT_GE(bench.forecasts, 20) << "once it keeps up again";
}

TEST(MirrorService, SaysHowOldTheTwinIs) {
  Bench bench(Identity().host);
  bench.clock.advance(MonotonicClock().now_ns() + 3600 * kSecond);
  bench.rounds(3, 1);
  EXPECT_TRUE(text_view(bench.status.text).starts_with("behind: ")) << text_view(bench.status.text);
  EXPECT_GE(bench.status.lateness_p50_ns, 3600 * kSecond);
  Bench remote("elsewhere");
  remote.clock.advance(MonotonicClock().now_ns() + 3600 * kSecond);
  remote.rounds(3, 1);
  EXPECT_EQ(remote.status.lateness_p50_ns, 0) << "clocks of two hosts cannot be compared";
}

}  // namespace
}  // namespace gyrotwin
