#include "clients/simulate/sampled_loop.hpp"

#include <algorithm>
#include <cmath>

#include "services/runtime/error.hpp"
#include "services/runtime/observation_wire.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

// Share of a tick that is surely inside of it and changes nothing else.
constexpr double kInside = 1e-9;
constexpr std::int64_t kEpoch = 1, kWriter = 1;  // one run, one controller

}  // namespace

SampledLoop::SampledLoop(const Rig& rig, const model::Machine& machine, const Scenario& scenario)
    : rig_(rig),
      machine_(machine),
      scenario_(scenario),
      needed_(groups_for_laws(machine)),
      schedule_(rig, machine),
      gate_(rig.safety.command_timeout_ticks, rig.loop.command_delay_ticks),
      safe_stop_(rig, machine) {
  if (!scenario.torque) law_.emplace(rig, machine);
  gate_.reset(kEpoch);
  if (rig.loop.state == StateSource::kEstimate) {
    sensing_.emplace(rig, machine);
    estimator_.emplace(rig, machine);
    sensing_->reset();
  }
  measure(0, scenario.start, {});
  if (estimator_) estimator_->reset(machine.observe(scenario.start));
  schedule(scenario);
}

void SampledLoop::schedule(const Scenario& scenario) {
  for (const Scenario::Event& event : scenario.events) {
    const bool on_sensor =
        event.request.verb == request_t::FAULT && event.request.kind <= request_t::SENSOR_DELAYED;
    if (on_sensor && !estimator_) {
      throw Error(event.place +
                  ": the law does not hear the sensors here; simulate with "
                  "`--set loop.state=estimate`, or leave the event out");
    }
    reply_t reply{};
    if (!schedule_.add(event.request, 0, reply)) {
      throw Error(event.place + ": refused: " + get_text(reply.text));
    }
  }
}

void SampledLoop::measure(std::int64_t tick, const model::State& state,
                          const model::Input& input) noexcept {
  if (!sensing_) return;
  sensing_->measure(tick, state, input, machine_.truth(state, input), sensors_);
  schedule_.corrupt(tick, sensors_);
}

void SampledLoop::look(std::int64_t k, const model::State& state,
                       const model::Input& input) noexcept {
  measure(k + 1, state, input);
  if (estimator_) estimator_->step(sensors_);
}

/// What the controller makes of STATE; empty when that tells too little to answer.
std::optional<model::Observation> SampledLoop::heard(const model::State& state) const noexcept {
  if (!estimator_) return machine_.observe(state);
  state_t message{};
  to_wire(estimator_->seen(), estimator_->valid() | state_t::VALID_DRIVES, message);
  if ((message.valid & needed_) != needed_) return std::nullopt;
  return from_wire(message);
}

std::optional<DriveTorques> SampledLoop::torques(double t, const model::State& state) noexcept {
  if (!law_) {
    // What jumps with the tick has jumped, whatever the rounding of its time.
    const double after = t + kInside * rig_.loop.tick_s();
    return scenario_.torque->value({after, after, state});
  }
  const std::optional<model::Observation> seen = heard(state);
  if (!seen) return std::nullopt;
  if (!law_started_) law_->reset(*seen);
  law_started_ = true;
  return law_->step(*seen);
}

void SampledLoop::command(std::int64_t k, const DriveTorques& torques) noexcept {
  command_t command{};
  command.mode = command_t::TORQUE_NM;
  command.valid_ticks = rig_.safety.command_timeout_ticks;
  std::ranges::copy(torques, command.value);
  command.for_tick = k;
  command.owner_epoch = kEpoch;
  command.writer = kWriter;
  command.counter = k + 1;
  gate_.offer(command, k);
}

const model::Input& SampledLoop::over_tick(std::int64_t k, double t,
                                           const model::State& state) noexcept {
  const std::optional<DriveTorques> wanted = torques(t, state);
  if (wanted && !schedule_.command_lost(k)) command(k, *wanted);
  if (!stopped_at_ && gate_.lost(k)) {
    stopped_at_ = k;
    safe_stop_.begin(state);
  }
  input_ = {};
  if (stopped_at_) {
    input_ = safe_stop_.input(state);
  } else if (const command_t* acting = gate_.acting(k)) {
    std::ranges::copy(acting->value, input_.drive.begin());
  }
  // A wire takes no such number; who gave it is to be told.
  if (wanted && std::ranges::any_of(*wanted, [](double x) { return !std::isfinite(x); })) {
    input_.drive = *wanted;
  }
  schedule_.apply(k, input_);
  return input_;
}

}  // namespace gyrotwin
