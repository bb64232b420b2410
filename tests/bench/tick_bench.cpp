// One tick of each daemon's core, and the steps of the plant inside it.
#include <benchmark/benchmark.h>

#include "services/controller/controller.hpp"
#include "services/integrator/integrator.hpp"

namespace gyrotwin {
namespace {

const char* const kRigs[] = {"prototype_b", "prototype_b_sleeping", "double_brennan"};

void plant_tick(benchmark::State& state) {
  const Rig rig = load_rig(kRigs[state.range(0)]);
  const model::Machine machine = rig.build_machine();
  Plant plant(machine, rig.loop.tick_s(), {.substeps = rig.loop.substeps});
  const model::State start = machine.state(rig.initial_q, rig.initial_v);
  plant.set_state(start);
  std::int64_t ticks = 0, evaluations = 0;
  for (auto _ : state) {
    if (++ticks % 100 == 0) plant.set_state(start);  // stay where the contact works
    plant.advance({});
    evaluations += plant.evaluations();
  }
  state.counters["evaluations"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
  state.SetLabel(kRigs[state.range(0)]);
}
BENCHMARK(plant_tick)->DenseRange(0, 2);

void integrator_tick(benchmark::State& state) {
  const Rig rig = load_rig(kRigs[state.range(0)], {"loop.clock=free"});
  Integrator integrator(rig, 1);
  request_t request{};
  request.owner_epoch = 1;
  request.verb = request_t::ARM;
  request.writer = request.counter = 1;
  reply_t reply;
  integrator.on_request(request, {.controller_heard = true}, reply);
  state_t out;
  truth_t truth;
  for (auto _ : state) {
    integrator.advance();
    integrator.fill(out);
    integrator.fill(truth);
    benchmark::DoNotOptimize(out);
    benchmark::DoNotOptimize(truth);
    if (integrator.tick() < 100) continue;
    request.verb = request_t::RESET;
    ++request.counter;
    integrator.on_request(request, {.fresh_epoch = 1}, reply);
    request.verb = request_t::ARM;
    ++request.counter;
    integrator.on_request(request, {.controller_heard = true}, reply);
  }
  state.SetLabel(kRigs[state.range(0)]);
}
BENCHMARK(integrator_tick)->DenseRange(0, 2);

void controller_answer(benchmark::State& state) {
  const Rig rig = load_rig(kRigs[state.range(0)]);
  const Integrator integrator(rig, 1);
  Controller controller(rig, 2);
  status_t status{};
  status.header.epoch = 1;
  controller.on_owner(status);
  state_t seen;
  integrator.fill(seen);
  seen.header.epoch = 1;
  seen.header.sequence = 0;
  seen.mode = status_t::MODE_RUNNING;
  command_t command;
  for (auto _ : state) {
    ++seen.header.sequence;
    controller.answer(seen, command);
    benchmark::DoNotOptimize(command);
  }
  state.SetLabel(kRigs[state.range(0)]);
}
BENCHMARK(controller_answer)->DenseRange(0, 2);

}  // namespace
}  // namespace gyrotwin
