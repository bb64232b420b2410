#include "clients/rig_emulator/bench_plant.hpp"

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

// Beyond this tilt a structure lies on the ground, which the model does not have [rad].
constexpr double kLyingTilt = 1.4;

const Rig& sensing(const Rig& rig) {
  if (rig.sensors) return rig;
  throw Error(rig.file.string() +
              ": an emulated rig needs [sensors]: all that is known of it is what they say");
}

}  // namespace

BenchPlant::BenchPlant(const Rig& rig)
    : rig_(sensing(rig)),
      machine_(rig.build_machine()),
      plant_(machine_, rig.loop.tick_s(), {.adaptive = false, .substeps = rig.loop.substeps}),
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
  } else {
    move(input_);
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
    lying_ = false;
    sound_ = true;
  }
  const int disc = machine_.layout.disc;
  if (disc != model::kFixed) state.q[disc] += state.v[disc] * rig_.loop.tick_s();
  spin(input, state);
  plant_.set_state(state);
}

void BenchPlant::move(const model::Input& input) noexcept {
  if (!sound_) return;
  if (lying_) {
    model::State state = plant_.state();
    spin(input, state);
    plant_.set_state(state);
    return;
  }
  if (!plant_.advance(input)) {
    sound_ = false;
  } else if (machine_.tilt(plant_.state()) > kLyingTilt) {
    model::State lying = plant_.state();
    lying.v.setZero();
    plant_.set_state(lying);
    lying_ = true;
  }
}

/// The rotors alone, over a tick, by the midpoint rule.
void BenchPlant::spin(const model::Input& input, model::State& state) const noexcept {
  const double h = rig_.loop.tick_s() / rig_.loop.substeps;
  const auto moved = [&state](const model::RotorSpeeds& rate, double dt) {
    model::State next = state;
    for (std::size_t j = 0; j < rate.size(); ++j) next.rotor_speed[j] += dt * rate[j];
    return next;
  };
  for (int k = 0; k < rig_.loop.substeps; ++k) {
    const model::State middle = moved(machine_.rotor_acceleration(state, input), 0.5 * h);
    state = moved(machine_.rotor_acceleration(middle, input), h);
  }
}

void BenchPlant::look() noexcept {
  sensing_.measure(tick_, plant_.state(), input_, truth_, sensors_);
  schedule_.corrupt(tick_, sensors_);
}

}  // namespace gyrotwin
