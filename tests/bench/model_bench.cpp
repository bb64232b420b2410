// Evaluations of the physics: what every step of the plant, the twin and the sweeps is made of.
#include <benchmark/benchmark.h>

#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using model::Input;
using model::Machine;
using model::Mount;
using model::State;
using model::TrackKind;

struct Case {
  Machine machine;
  State state;
};

/// Near upright, the disc at -5 rad/s; with a track all axles press on it.
Case umbrella(Mount mount, TrackKind track) {
  auto p = reference::umbrella("prototype_b");
  p.mount = mount;
  p.track = track;
  Machine machine = model::build(p);
  State state = machine.state({1e-4, 2e-4}, {0.1, 0.1});
  state.q[machine.layout.disc] = 0.3;
  state.v[machine.layout.disc] = -5.0;
  state.q[machine.layout.disc + 1] = -0.01;
  return {machine, state};
}

Case gimballed(const std::string& set) {
  Machine machine = model::build(reference::gimballed(set));
  const bool two = machine.coordinates() == 4;
  const State state = two ? machine.state({0.01, 0.02, 0.1, 0.2}, {0.1, 0.1, 0.1, 0.1})
                          : machine.state({0.01, 0.1}, {0.1, 0.1});
  return {machine, state};
}

void acceleration(benchmark::State& bench, const Case& c) {
  State state = c.state;
  const Input input;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(state);
    benchmark::DoNotOptimize(c.machine.acceleration(state, input));
  }
}

void truth(benchmark::State& bench, const Case& c) {
  State state = c.state;
  const Input input;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(state);
    benchmark::DoNotOptimize(c.machine.truth(state, input));
  }
}

BENCHMARK_CAPTURE(acceleration, level_contact, umbrella(Mount::kLevel, TrackKind::kLower));
BENCHMARK_CAPTURE(acceleration, level_free, umbrella(Mount::kLevel, TrackKind::kNone));
BENCHMARK_CAPTURE(acceleration, rigid_contact, umbrella(Mount::kRigid, TrackKind::kLower));
BENCHMARK_CAPTURE(acceleration, rigid_free, umbrella(Mount::kRigid, TrackKind::kNone));
BENCHMARK_CAPTURE(acceleration, universal_contact,
                  umbrella(Mount::kUniversalJoint, TrackKind::kLower));
BENCHMARK_CAPTURE(acceleration, universal_free, umbrella(Mount::kUniversalJoint, TrackKind::kNone));
BENCHMARK_CAPTURE(acceleration, single, gimballed("gyrocar"));
BENCHMARK_CAPTURE(acceleration, pair, gimballed("brennan_monorail"));
BENCHMARK_CAPTURE(acceleration, two_pairs, gimballed("double_brennan"));
BENCHMARK_CAPTURE(truth, level_contact, umbrella(Mount::kLevel, TrackKind::kLower));
BENCHMARK_CAPTURE(truth, universal_contact, umbrella(Mount::kUniversalJoint, TrackKind::kLower));
BENCHMARK_CAPTURE(truth, two_pairs, gimballed("double_brennan"));

}  // namespace
}  // namespace gyrotwin
