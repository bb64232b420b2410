#include "tests/bench/plant/scenario.hpp"

#include "services/integrator/plant.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/random_machine.hpp"

namespace gyrotwin::bench {

model::Input scenario_input(const Rig& rig, const model::Machine& machine, int tick) {
  model::Input input = stepping_input(rig, machine, tick);
  input.mode = model::DriveMode::kIdealTorque;
  return input;
}

std::vector<Sample> trajectory(const Rig& rig) {
  const model::Machine machine = rig.build_machine();
  Plant plant(machine, rig.loop.tick_s(), {.substeps = rig.loop.substeps});
  plant.set_state(machine.state(rig.initial_q, rig.initial_v));
  std::vector<Sample> samples;
  for (int k = 0; k < kTrajectoryTicks; ++k) {
    samples.push_back({plant.state(), scenario_input(rig, machine, k)});
    if (!plant.advance(samples.back().input)) throw Error(rig.name + ": the plant failed");
  }
  return samples;
}

std::vector<Sample> random_samples(const Rig& rig, int count) {
  const model::Machine machine = rig.build_machine();
  const model::State start = machine.state(rig.initial_q, rig.initial_v);
  reference::Random random(20);
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    Sample sample{start, {}};
    for (int i = 0; i < machine.coordinates(); ++i) {
      sample.state.q[i] += random.between(-0.02, 0.02);
      sample.state.v[i] += random.between(-0.5, 0.5);
    }
    sample.input.mode = model::DriveMode::kIdealTorque;
    for (std::size_t i = 0; i < machine.drives.size(); ++i) {
      sample.input.drive[i] = random.between(-1, 1) * machine.drives[i].torque_limit;
    }
    sample.input.moment = random.vector(0.2 * rig.reference_impulse_nms / rig.impulse_duration_s);
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace gyrotwin::bench
