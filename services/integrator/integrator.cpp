#include "services/integrator/integrator.hpp"

#include <algorithm>
#include <cmath>

#include "services/runtime/observation_wire.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

// Beyond this tilt a structure lies on the ground, which the model does not have [rad].
constexpr double kLyingTilt = 1.4;

static_assert(Rig::Loop::kMaxCommandDelay == CommandGate::kMaxDelay);

template <std::size_t N>
void copy(const std::array<double, N>& from, double (&to)[N]) {
  std::copy(from.begin(), from.end(), std::begin(to));
}

void copy(const Eigen::Vector3d& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }

}  // namespace

Integrator::Integrator(const Rig& rig, std::int64_t epoch)
    : rig_(rig),
      machine_(rig.build_machine()),
      valid_(valid_groups(machine_)),
      plant_(machine_, rig.loop.tick_s(), {.adaptive = false, .substeps = rig.loop.substeps}),
      gate_(rig.safety.command_timeout_ticks, rig.loop.command_delay_ticks),
      epoch_(epoch) {
  plant_.advance(input_);  // SUNDIALS allocates in its first step: now, before time counts
  plant_.set_state(machine_.state(rig.initial_q, rig.initial_v));
  truth_ = machine_.truth(plant_.state(), input_);
  gate_.reset(epoch);
}

void Integrator::enter(Event event, std::string_view why) noexcept {
  const std::optional<Mode> to = next(mode_, event);
  if (!to) return;
  if (*to == Mode::kSafeStop) {
    for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
      held_speed_[i] = machine_.drive_rate(static_cast<int>(i), plant_.state());
    }
  }
  waiting_for_controller_ = event == Event::kNoController;
  if (event == Event::kNoController) gate_.release();
  const bool goes_on =
      event == Event::kStep || event == Event::kNoController || event == Event::kControllerBack;
  if (!goes_on) steps_left_ = 0;
  mode_ = *to;
  set_text(why_, "{}", why);
}

void Integrator::notice(Event event, std::string_view why) noexcept { enter(event, why); }

bool Integrator::on_command(const command_t& command) noexcept {
  const bool wanted = mode_ == Mode::kRunning || mode_ == Mode::kPaused;
  return wanted && gate_.offer(command, tick_);
}

model::Input Integrator::commanded() noexcept {
  model::Input input;
  const command_t* command = gate_.acting(tick_);
  if (command == nullptr) return input;
  input.mode = command->mode == command_t::VOLTAGE_V ? model::DriveMode::kVoltage
                                                     : model::DriveMode::kTorque;
  std::copy(std::begin(command->value), std::end(command->value), input.drive.begin());
  return input;
}

model::Input Integrator::safe_stop() const noexcept {
  model::Input input;
  if (rig_.safety.drive == SafeStopDrive::kBrake) {
    input.mode = model::DriveMode::kBrake;
    input.drive.fill(rig_.safety.gain);
  }
  if (rig_.safety.drive == SafeStopDrive::kHoldSpeed) {
    for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
      const double rate = machine_.drive_rate(static_cast<int>(i), plant_.state());
      input.drive[i] = rig_.safety.gain * (held_speed_[i] - rate);
    }
  }
  return input;
}

void Integrator::advance() noexcept {
  if (!ticks(mode_)) return;
  if (command_lost()) {
    enter(Event::kCommandLost,
          "no valid command in time; start the controller, then reset and arm");
  }
  model::Input input = mode_ == Mode::kRunning ? commanded() : safe_stop();
  disturbances_.apply(tick_, input);

  history_[recorded_++ % kHistory] = {tick_, plant_.state(), input};
  if (!lying_ && !plant_.advance(input)) {
    enter(Event::kNotFinite,
          "the solver failed or the state is not finite; the log has the last ticks");
    return;
  }
  ++tick_;
  input_ = input;
  evaluations_max_ = std::max(evaluations_max_, plant_.evaluations());
  truth_ = machine_.truth(plant_.state(), input_);

  const double tilt = machine_.tilt(plant_.state());
  if (tilt > rig_.safety.fall_tilt_rad)
    enter(Event::kTiltLimit, "tilt beyond safety.fall_tilt_rad");
  if (tilt > kLyingTilt && !lying_) {
    model::State lying = plant_.state();
    lying.v.setZero();
    plant_.set_state(lying);
    lying_ = true;
  }
  if (steps_left_ > 0 && --steps_left_ == 0) enter(Event::kStepsDone, "the ticks of step are done");
}

void Integrator::fill(state_t& state) const noexcept {
  state.mode = static_cast<std::int32_t>(mode_);
  to_wire(machine_.observe(plant_.state()), valid_, state);
  copy(truth_.drive_torque, state.drive_torque_nm);
}

void Integrator::fill(truth_t& truth) const noexcept {
  copy(truth_.contact_lower, truth.contact_lower_n);
  copy(truth_.contact_upper, truth.contact_upper_n);
  copy(truth_.holding_moment, truth.holding_moment_nm);
  truth.kinetic_energy_j = truth_.kinetic_energy;
  truth.potential_energy_j = truth_.potential_energy;
  copy(truth_.angular_momentum, truth.angular_momentum_nms);
  copy(input_.force, truth.external_force_n);
  copy(input_.moment, truth.external_moment_nm);
  truth.tilt_margin_rad = rig_.safety.fall_tilt_rad - machine_.tilt(plant_.state());
  truth.gimbal_margin_rad = truth_.gimbal_margin;
  copy(truth_.drive_margin, truth.drive_margin_nm);
}

void Integrator::fill(status_t& status) const noexcept {
  status.service = status_t::INTEGRATOR;
  status.mode = static_cast<std::int32_t>(mode_);
  set_text(status.text, "{}", text_view(why_));
  status.speed_factor = speed_;
  status.tick_period_ns = rig_.loop.tick_ns();
  status.rhs_evaluations_max = evaluations_max_;
  const bool leased = mode_ == Mode::kPaused || (mode_ == Mode::kRunning && !gate_.lost(tick_));
  status.command_writer = leased ? gate_.writer() : 0;
  status.command_counter = gate_.counter();
  status.request_writer = request_writer_;
  status.request_counter = request_counter_;
  const CommandGate::Refusals& refused = gate_.refusals();
  status.refused_not_finite = refused.not_finite;
  status.refused_epoch = refused.epoch;
  status.refused_expired = refused.expired;
  status.refused_counter = refused.counter;
  status.refused_writer = refused.writer;
}

}  // namespace gyrotwin
