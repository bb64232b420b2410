#include "clients/rig_emulator/bench_plant.hpp"

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

const Rig& sensing(const Rig& rig) {
  if (rig.sensors) return rig;
  throw Error(rig.file.string() +
              ": an emulated rig needs [sensors]: all that is known of it is what they say");
}

}  // namespace

BenchPlant::BenchPlant(const Rig& rig)
    : rig_(sensing(rig)),
      machine_(rig.build_machine()),
      plant_(machine_, rig.loop),
      schedule_(rig, machine_),
      sensing_(rig, machine_) {
  plant_.advance(input_);  // SUNDIALS allocates in its first step: now, before time counts
  plant_.set_state(rig.initial_state(machine_));
  truth_ = machine_.truth(plant_.state(), input_);
  look();
}

void BenchPlant::advance(bool propped, const model::Input& drives) noexcept {
  input_ = drives;
  input_.rotor_powered.fill(rotors_powered);
  schedule_.apply(tick_, input_);
  if (propped) {
    hold(input_);
  } else if (sound_) {
    sound_ = plant_.advance(input_);
  }
  propped_ = propped;
  ++tick_;
  truth_ = machine_.truth(plant_.state(), input_);
  look();
}

void BenchPlant::hold(const model::Input& input) noexcept {
  model::State state = plant_.state();
  if (!propped_) {
    const model::State initial = rig_.initial_state(machine_);
    state.q = initial.q;
    state.v = initial.v;
    sound_ = true;
  }
  const int disc = machine_.layout.disc;
  if (disc != model::kFixed) state.q[disc] += state.v[disc] * rig_.loop.tick_s();
  plant_.set_state(state);
  plant_.run_rotors(input, rig_.loop.tick_s());
}

void BenchPlant::look() noexcept {
  sensing_.measure(tick_, plant_.state(), input_, truth_, sensors_);
  schedule_.corrupt(tick_, sensors_);
}

}  // namespace gyrotwin
