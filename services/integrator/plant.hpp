// A simulated plant: a machine, its state and the stepper that moves it, tick by tick.
#pragma once

#include <cstdint>

#include "services/integrator/stepper.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// A state as one vector for the stepper: (q, v), and with a rotor_drive the rotor speeds.
int packed_size(const model::Machine& machine) noexcept;
void pack(const model::Machine& machine, const model::State& state, double* y) noexcept;
/// @param held_rotor_speed what a machine without a rotor_drive keeps [rad/s]
model::State unpack(const model::Machine& machine, const double* y,
                    const model::RotorSpeeds& held_rotor_speed) noexcept;
/// The packed vector's time derivative.
void packed_rates(const model::Machine& machine, const model::State& state,
                  const model::Input& input, double* dy) noexcept;

/// The machine's equations with the input held.
class MachineOde : public Ode {
 public:
  explicit MachineOde(const model::Machine& machine) : machine_(machine) {}
  int size() const noexcept override { return packed_size(machine_); }
  void rates(double t, const double* y, double* dy) noexcept override;

  model::Input input;
  model::RotorSpeeds held_rotor_speed{};

 private:
  const model::Machine& machine_;
};

/// Advances a machine one tick at a time with the input held over the tick.
class Plant {
 public:
  /// @param machine outlives the plant
  Plant(const model::Machine& machine, double tick_s, const StepPolicy& policy);

  const model::Machine& machine() const noexcept { return machine_; }
  const model::State& state() const noexcept { return state_; }
  void set_state(const model::State& state) noexcept { state_ = state; }

  /// One tick. @return false when the solver failed or the state is not finite; the state then is
  /// still that before the tick.
  bool advance(const model::Input& input) noexcept;

  /// Right-hand sides of the last tick.
  std::int64_t evaluations() const noexcept { return stepper_.evaluations(); }

 private:
  const model::Machine& machine_;
  double tick_s_;
  MachineOde ode_;
  Stepper stepper_;
  model::State state_;
};

/// A plant with the ground under it, at the rig's ticks.
class GroundedPlant {
 public:
  /// Beyond this tilt a structure lies on the ground, which the model does not have: it comes to
  /// rest, and its rotors alone move on [rad].
  static constexpr double kLyingTilt = 1.4;

  /// @param machine outlives the plant
  GroundedPlant(const model::Machine& machine, const Rig::Loop& loop);

  const model::Machine& machine() const noexcept { return plant_.machine(); }
  const model::State& state() const noexcept { return plant_.state(); }
  void set_state(const model::State& state) noexcept;

  /// As Plant::advance().
  bool advance(const model::Input& input) noexcept;
  /// The rotors alone, for so long [s], in steps as in a tick.
  void run_rotors(const model::Input& input, double seconds) noexcept;

  std::int64_t evaluations() const noexcept { return plant_.evaluations(); }

 private:
  Plant plant_;
  double tick_s_;
  int substeps_;
  bool lying_ = false;
};

/// How long the scenario goes on that steps are judged by [s].
inline constexpr double kSteppingDuration = 0.25;
/// What acts in it over a tick: the reference push, and the drives swinging through a tenth of
/// their torque limit.
model::Input stepping_input(const Rig& rig, const model::Machine& machine, int tick);

/// Largest error [rad] of any coordinate of the rig's fixed-step plant against a tight adaptive
/// solution, over that scenario from the initial state at nominal rotor speeds.
double stepping_error(const Rig& rig, const model::Machine& machine);

}  // namespace gyrotwin
