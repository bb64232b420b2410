#include "services/integrator/plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace gyrotwin {

namespace {

/// Copies n numbers, 1 to `largest`, in line: for so few a call costs more. memcpy, whose arrays
/// are known to lie apart, is one move each; copy_n of more than two is a call.
template <int largest>
[[gnu::always_inline]] inline void copy_few(int n, const double* from, double* to) noexcept {
  if constexpr (largest > 1) {
    if (n < largest) return copy_few<largest - 1>(n, from, to);
  }
  std::memcpy(to, from, largest * sizeof *to);
}

/// A state's parts, or their rates.
void put(const model::Machine& machine, const model::Coordinates& q, const model::Coordinates& v,
         const model::RotorSpeeds& rotors, double* y) noexcept {
  const int n = machine.coordinates();
  copy_few<model::kMaxCoordinates>(n, q.data(), y);
  copy_few<model::kMaxCoordinates>(n, v.data(), y + n);
  if (machine.rotor_drive) copy_few<model::kMaxRotors>(machine.rotors, rotors.data(), y + 2 * n);
}

}  // namespace

int packed_size(const model::Machine& machine) noexcept {
  return 2 * machine.coordinates() + (machine.rotor_drive ? machine.rotors : 0);
}

void pack(const model::Machine& machine, const model::State& state, double* y) noexcept {
  put(machine, state.q, state.v, state.rotor_speed, y);
}

model::State unpack(const model::Machine& machine, const double* y,
                    const model::RotorSpeeds& held_rotor_speed) noexcept {
  const int n = machine.coordinates();
  model::State state;
  copy_few<model::kMaxCoordinates>(n, y, state.q.data());
  copy_few<model::kMaxCoordinates>(n, y + n, state.v.data());
  state.rotor_speed = held_rotor_speed;
  if (machine.rotor_drive) {
    copy_few<model::kMaxRotors>(machine.rotors, y + 2 * n, state.rotor_speed.data());
  }
  return state;
}

void packed_rates(const model::Machine& machine, const model::State& state,
                  const model::Input& input, double* dy) noexcept {
  const model::RotorSpeeds rotor_rate = machine.rotor_acceleration(state, input);
  put(machine, state.v, machine.acceleration(state, input, rotor_rate), rotor_rate, dy);
}

void MachineOde::rates(double, const double* y, double* dy) noexcept {
  packed_rates(machine_, unpack(machine_, y, held_rotor_speed), input, dy);
}

Plant::Plant(const model::Machine& machine, double tick_s, const StepPolicy& policy)
    : machine_(machine), tick_s_(tick_s), ode_(machine), stepper_(ode_, policy) {}

bool Plant::advance(const model::Input& input) noexcept {
  ode_.input = input;
  ode_.held_rotor_speed = state_.rotor_speed;
  std::array<double, 2 * model::kMaxCoordinates + model::kMaxRotors> y;
  pack(machine_, state_, y.data());
  // Every tick from 0: the same state and input give the same bits at any tick.
  const bool ok = stepper_.advance(0.0, tick_s_, {y.data(), static_cast<std::size_t>(ode_.size())});
  const model::State next = unpack(machine_, y.data(), state_.rotor_speed);
  if (!ok || !next.finite()) return false;
  state_ = next;
  return true;
}

GroundedPlant::GroundedPlant(const model::Machine& machine, const Rig::Loop& loop)
    : plant_(machine, loop.tick_s(), {.substeps = loop.substeps}),
      tick_s_(loop.tick_s()),
      substeps_(loop.substeps) {}

void GroundedPlant::set_state(const model::State& state) noexcept {
  plant_.set_state(state);
  lying_ = false;
}

bool GroundedPlant::advance(const model::Input& input) noexcept {
  if (lying_) {
    run_rotors(input, tick_s_);
    return true;
  }
  if (!plant_.advance(input)) return false;
  if (machine().tilt(state()) > kLyingTilt) {
    model::State lying = state();
    lying.v.setZero();
    plant_.set_state(lying);
    lying_ = true;
  }
  return true;
}

void GroundedPlant::run_rotors(const model::Input& input, double seconds) noexcept {
  const double h = tick_s_ / substeps_;
  model::State state = plant_.state();
  const auto moved = [&state](const model::RotorSpeeds& rate, double dt) {
    model::State next = state;
    for (std::size_t j = 0; j < rate.size(); ++j) next.rotor_speed[j] += dt * rate[j];
    return next;
  };
  for (std::int64_t k = std::llround(seconds / h); k > 0; --k) {
    const model::State middle = moved(machine().rotor_acceleration(state, input), 0.5 * h);
    state = moved(machine().rotor_acceleration(middle, input), h);
  }
  plant_.set_state(state);
}

model::Input stepping_input(const Rig& rig, const model::Machine& machine, int tick) {
  constexpr double kFrequency = 8.0;   // of the drive torque [Hz]
  constexpr double kDriveShare = 0.1;  // of the torque limit
  const double t = tick * rig.loop.tick_s();
  model::Input input;
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    input.drive[i] = kDriveShare * machine.drives[i].torque_limit *
                     std::sin(2.0 * std::numbers::pi * kFrequency * t);
  }
  if (t < rig.impulse_duration_s) {
    input.moment.x() = rig.reference_impulse_nms / rig.impulse_duration_s;
  }
  return input;
}

double stepping_error(const Rig& rig, const model::Machine& machine) {
  const double dt = rig.loop.tick_s();
  Plant fixed(machine, dt, {.substeps = rig.loop.substeps});
  Plant tight(machine, dt, {StepPolicy::Kind::kAdaptive});
  fixed.set_state(machine.state(rig.initial_q, rig.initial_v));
  tight.set_state(fixed.state());

  double worst = 0.0;
  const int ticks = static_cast<int>(kSteppingDuration / dt);
  for (int k = 0; k < ticks; ++k) {
    const model::Input input = stepping_input(rig, machine, k);
    if (!fixed.advance(input) || !tight.advance(input)) return HUGE_VAL;
    worst = std::max(worst, (fixed.state().q - tight.state().q).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace gyrotwin
