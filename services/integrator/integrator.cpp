#include "services/integrator/integrator.hpp"

#include <algorithm>
#include <cmath>

#include "services/onboard/drive_torques.hpp"
#include "services/runtime/observation_wire.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

static_assert(Rig::Loop::kMaxCommandDelay == CommandGate::kMaxDelay);

template <std::size_t N>
void copy(const std::array<double, N>& from, double (&to)[N]) {
  std::copy(from.begin(), from.end(), std::begin(to));
}

void copy(const Eigen::Vector3d& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }

void copy(const model::Coordinates& from, double (&to)[model::kMaxCoordinates]) {
  std::copy_n(from.data(), model::kMaxCoordinates, to);
}

}  // namespace

Integrator::Integrator(const Rig& rig, std::int64_t epoch)
    : Owner(rig, epoch),
      machine_(rig.build_machine()),
      valid_(valid_groups(machine_)),
      plant_(machine_, rig.loop),
      schedule_(rig, machine_),
      safe_stop_(rig, machine_) {
  if (rig.sensors) sensing_.emplace(rig, machine_);
  if (rig.sensors && rig.loop.state == StateSource::kEstimate) estimator_.emplace(rig, machine_);
  plant_.advance(input_);  // SUNDIALS allocates in its first step: now, before time counts
  stand(rig.initial_state(machine_));
}

/// At tick 0 in this state, at rest for everybody who looks.
void Integrator::stand(const model::State& state) noexcept {
  plant_.set_state(state);
  input_ = {};
  truth_ = machine_.truth(state, input_);
  if (sensing_) sensing_->reset();
  look();
  if (estimator_) estimator_->reset(machine_.observe(state));
}

/// What the sensors say at the present tick.
void Integrator::look() noexcept {
  if (!sensing_) return;
  sensing_->measure(tick_, plant_.state(), input_, truth_, sensors_);
  schedule_.corrupt(tick_, sensors_);
}

bool Integrator::hold(double seconds) noexcept {
  if (mode() != Mode::kHeld || !rotors_asked_) return false;
  const model::RotorSpeeds before = plant_.state().rotor_speed;
  model::Input input;
  input.rotor_powered.fill(rotors_powered());
  plant_.run_rotors(input, seconds);
  stand(plant_.state());
  return plant_.state().rotor_speed != before;
}

void Integrator::entering(Event event, Mode to) noexcept {
  if (to == Mode::kSafeStop) safe_stop_.begin(plant_.state());
  waiting_for_controller_ = event == Event::kNoController;
  if (event == Event::kNoController) gate_.release();
  const bool goes_on =
      event == Event::kStep || event == Event::kNoController || event == Event::kControllerBack;
  if (!goes_on) steps_left_ = 0;
}

bool Integrator::on_command(const command_t& command) noexcept {
  if ((mode() == Mode::kRunning || mode() == Mode::kPaused) && command_link_cut()) {
    if (command.owner_epoch == epoch() && command.for_tick == tick_) unobeyed_tick_ = tick_;
    return false;
  }
  return Owner::on_command(command);
}

model::Input Integrator::commanded() noexcept {
  model::Input input;
  if (const command_t* command = gate_.acting(tick_)) from_wire(*command, input);
  return input;
}

void Integrator::advance() noexcept {
  if (!ticks(mode())) return;
  if (command_lost()) {
    enter(Event::kCommandLost,
          command_link_cut()
              ? "no valid command in time: a fault cuts the command link; reset and arm"
              : "no valid command in time; start the controller, then reset and arm");
  }
  model::Input input = mode() == Mode::kRunning ? commanded() : safe_stop_.input(plant_.state());
  input.rotor_powered.fill(rotors_powered());
  schedule_.apply(tick_, input);

  history_[recorded_++ % kHistory] = {tick_, plant_.state(), input};
  if (!plant_.advance(input)) {
    enter(Event::kNotFinite,
          "the solver failed or the state is not finite; the log has the last ticks");
    return;
  }
  ++tick_;
  input_ = input;
  evaluations_max_ = std::max(evaluations_max_, plant_.evaluations());
  truth_ = machine_.truth(plant_.state(), input_);

  if (machine_.tilt(plant_.state()) > rig_.safety.fall_tilt_rad) {
    fall();
  }
  look();
  if (estimator_) estimator_->step(sensors_);
  if (steps_left_ > 0 && --steps_left_ == 0) enter(Event::kStepsDone, "the ticks of step are done");
}

void Integrator::fill(state_t& state) const noexcept {
  state.mode = static_cast<std::int32_t>(mode());
  if (estimator_) {
    to_wire(estimator_->seen(), estimator_->valid() | state_t::VALID_DRIVES, state);
    copy(drive_torques(machine_, estimator_->seen(), sensors_, input_), state.drive_torque_nm);
  } else {
    to_wire(machine_.observe(plant_.state()), valid_, state);
    copy(truth_.drive_torque, state.drive_torque_nm);
  }
}

void Integrator::fill(truth_t& truth) const noexcept {
  copy(plant_.state().q, truth.q);
  copy(plant_.state().v, truth.v);
  copy(truth_.contact_lower, truth.contact_lower_n);
  copy(truth_.contact_upper, truth.contact_upper_n);
  copy(truth_.holding_moment, truth.holding_moment_nm);
  truth.kinetic_energy_j = truth_.kinetic_energy;
  truth.potential_energy_j = truth_.potential_energy;
  copy(truth_.angular_momentum, truth.angular_momentum_nms);
  copy(input_.force, truth.external_force_n);
  copy(input_.moment, truth.external_moment_nm);
  copy(input_.ground_acceleration, truth.ground_acceleration_m_s2);
  truth.yaw_rate_rad_s = input_.yaw_rate;
  truth.added_mass_kg = 0.0;
  for (const model::PointMass& added : input_.added) truth.added_mass_kg += added.mass;
  truth.load_cell_n = truth_.load_cell;
  truth.tilt_margin_rad = rig_.safety.fall_tilt_rad - machine_.tilt(plant_.state());
  truth.gimbal_margin_rad = truth_.gimbal_margin;
  copy(truth_.drive_margin, truth.drive_margin_nm);
}

void Integrator::fill(status_t& status) const noexcept {
  fill_owner(status);
  status.service = status_t::INTEGRATOR;
  if (status.text[0] == 0 && mode() == Mode::kRunning && command_link_cut()) {
    set_text(status.text, "a fault cuts the command link: commands are not obeyed");
  }
  status.disturbances = schedule_.disturbances();
  status.faults = schedule_.faults();
  status.speed_factor = speed_;
  status.rhs_evaluations_max = evaluations_max_;
}

}  // namespace gyrotwin
