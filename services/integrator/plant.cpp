#include "services/integrator/plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gyrotwin {

void pack(const model::State& state, int coordinates, double* y) noexcept {
  std::copy_n(state.q.data(), coordinates, y);
  std::copy_n(state.v.data(), coordinates, y + coordinates);
}

model::State unpack(const double* y, int coordinates,
                    const model::RotorSpeeds& rotor_speed) noexcept {
  model::State state;
  std::copy_n(y, coordinates, state.q.data());
  std::copy_n(y + coordinates, coordinates, state.v.data());
  state.rotor_speed = rotor_speed;
  return state;
}

void MachineOde::rates(double, const double* y, double* dy) noexcept {
  const int n = machine_.coordinates();
  const model::State state = unpack(y, n, rotor_speed);
  const model::Coordinates acceleration = machine_.acceleration(state, input);
  std::copy_n(state.v.data(), n, dy);
  std::copy_n(acceleration.data(), n, dy + n);
}

Plant::Plant(const model::Machine& machine, double tick_s, const StepPolicy& policy)
    : machine_(machine), tick_s_(tick_s), ode_(machine), stepper_(ode_, policy) {}

bool Plant::advance(const model::Input& input) noexcept {
  ode_.input = input;
  ode_.rotor_speed = state_.rotor_speed;
  std::array<double, 2 * model::kMaxCoordinates> y;
  const int n = machine_.coordinates();
  pack(state_, n, y.data());
  // Every tick from 0: the same state and input give the same bits at any tick.
  const bool ok = stepper_.advance(0.0, tick_s_, {y.data(), 2 * static_cast<std::size_t>(n)});
  const model::State next = unpack(y.data(), n, state_.rotor_speed);
  if (!ok || !next.finite()) return false;
  state_ = next;
  return true;
}

double stepping_error(const Rig& rig, const model::Machine& machine) {
  constexpr double kDuration = 0.25;   // [s]
  constexpr double kFrequency = 8.0;   // of the drive torque [Hz]
  constexpr double kDriveShare = 0.1;  // of the torque limit
  const double dt = rig.loop.tick_s();
  Plant fixed(machine, dt, {.adaptive = false, .substeps = rig.loop.substeps});
  Plant tight(machine, dt, {.adaptive = true});
  fixed.set_state(machine.state(rig.initial_q, rig.initial_v));
  tight.set_state(fixed.state());

  double worst = 0.0;
  const int ticks = static_cast<int>(kDuration / dt);
  for (int k = 0; k < ticks; ++k) {
    model::Input input;
    for (std::size_t i = 0; i < machine.drives.size(); ++i) {
      input.drive[i] = kDriveShare * machine.drives[i].torque_limit *
                       std::sin(2.0 * std::numbers::pi * kFrequency * k * dt);
    }
    if (k * dt < rig.impulse_duration_s) {
      input.moment.x() = rig.reference_impulse_nms / rig.impulse_duration_s;
    }
    if (!fixed.advance(input) || !tight.advance(input)) return HUGE_VAL;
    worst = std::max(worst, (fixed.state().q - tight.state().q).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace gyrotwin
