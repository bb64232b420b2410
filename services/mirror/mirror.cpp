#include "services/mirror/mirror.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/mirror/readings.hpp"
#include "services/onboard/drive_torques.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/observation_wire.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr double kMisfitWindow = 0.2, kWorst = 25.0;  // [s], of one sensor

}  // namespace

Mirror::Mirror(const Rig& rig, const ForecastSettings& forecast)
    : rig_(rig),
      machine_(rig.build_machine()),
      gate_(rig.safety.command_timeout_ticks, rig.loop.command_delay_ticks),
      safe_stop_(rig, machine_),
      follower_(rig, machine_),
      health_(rig, machine_),
      forecast_(rig, machine_, forecast),
      health_period_(
          std::max<std::int64_t>(1, std::llround(1.0 / (kHealthRate * rig.loop.tick_s())))) {}

void Mirror::begin_run(std::int64_t epoch) noexcept {
  epoch_ = epoch;
  gate_.reset(epoch);
  early_count_ = 0;
  health_.reset();
  forecast_.reset();
  mode_before_ = status_t::MODE_HELD;
  started_ = portion_due_ = health_due_ = was_settled_ = from_rest_ = false;
  sensors_ = {};
  acting_ = {};
  stopped_from_.reset();
}

void Mirror::on_owner(const status_t& status) noexcept {
  if (status.header.epoch != epoch_) begin_run(status.header.epoch);
  mode_ = status.mode;
}

void Mirror::on_state(const state_t& state) noexcept {
  if (state.header.epoch == epoch_) mode_ = state.mode;
}

void Mirror::on_command(const command_t& command) noexcept {
  if (command.for_tick > sensors_.header.tick) {
    early_[early_count_++ % early_.size()] = command;
  } else {
    gate_.offer(command, sensors_.header.tick);
  }
}

/// A controller that answers STATE at once may be heard before the SENSORS of that tick.
void Mirror::offer_early(std::int64_t tick) noexcept {
  for (std::size_t i = 0; i < std::min(early_count_, early_.size()); ++i) {
    if (early_[i].for_tick <= tick) gate_.offer(early_[i], tick);
  }
  early_count_ = 0;
}

/// A fall, a fault or a pause ends a tick; any other end of RUNNING came before it.
bool Mirror::runs_over_last_tick() const noexcept {
  if (mode_ == status_t::MODE_RUNNING) return true;
  return mode_before_ == status_t::MODE_RUNNING && mode_ != status_t::MODE_SAFE_STOP;
}

/// What the drives did over a tick, as the owner goes about it.
model::Input Mirror::acted(std::int64_t tick) noexcept {
  const model::State& state = follower_.estimate().state;
  if (!runs_over_last_tick()) {
    if (!stopped_from_) safe_stop_.begin(stopped_from_.emplace(state));
    return safe_stop_.input(state);
  }
  model::Input input;
  if (const command_t* command = gate_.acting(tick)) from_wire(*command, input);
  return input;
}

void Mirror::watch_settling(std::int64_t tick) noexcept {
  const bool settled = follower_.settled();
  if (!started_ || (was_settled_ && !settled)) {
    unsettled_since_ = tick;
    misfit_ = 1.0;
    from_rest_ = tick == 0;
  }
  was_settled_ = settled;
}

void Mirror::watch_misfit() noexcept {
  double sum = 0.0;
  int channels = 0;
  for (int s = 0; s < kHealthSensors; ++s) {
    const Innovation& innovation = follower_.innovations()[s];
    // Rotor speeds are taken as they are said.
    if (s == kRotors || innovation.channels == 0) continue;
    sum += std::min(innovation.nis, kWorst * innovation.channels);
    channels += innovation.channels;
  }
  if (channels == 0) return;
  misfit_ += rig_.loop.tick_s() / kMisfitWindow * (sum / channels - misfit_);
}

/// Where the rig is, is known well enough for a forecast. Without a gyro nothing shows how it
/// tilts.
bool Mirror::ripe() const noexcept {
  const std::int64_t ticks = sensors_.header.tick - unsettled_since_;
  const bool turns_known = sensors_.valid & ~health_.distrusted() & sensors_t::VALID_GYRO;
  return started_ && static_cast<double>(ticks) * rig_.loop.tick_s() >= kRipe && turns_known &&
         misfit_ < kContradicted;
}

/// What lies on the ground is not what the model moves.
bool Mirror::over() const noexcept {
  return mode_ == status_t::MODE_FALLEN || mode_ == status_t::MODE_FAULT;
}

/// What a forecast remembers, it remembers of every tick.
void Mirror::keep_forecast_up() noexcept {
  if (sensors_.header.tick == 0) return;
  const bool obeys = mode_ == status_t::MODE_RUNNING || mode_ == status_t::MODE_PAUSED;
  if (!obeys && !stopped_from_) {
    safe_stop_.begin(stopped_from_.emplace(follower_.estimate().state));
  }
  forecast_.follow(follower_.estimate(), sensors_.header, obeys ? nullptr : &*stopped_from_);
  portion_due_ = ripe() && !over();
  if (!portion_due_) forecast_.break_off();
}

bool Mirror::on_sensors(const sensors_t& sensors) noexcept {
  health_due_ = portion_due_ = false;
  const header_t& before = sensors_.header;
  const header_t& now = sensors.header;
  if (now.epoch != epoch_ || (started_ && now.sequence < before.sequence)) return false;
  const bool news = !started_ || now.sequence > before.sequence;
  // While HELD each repeat may tell of rotors that run.
  const bool at_rest = now.tick == 0;
  if (!news && !at_rest) return follows();

  if (!started_ || at_rest) {
    follower_.start(sensors);
    acting_ = {};
    watch_settling(now.tick);
    started_ = true;
  } else {
    acting_ = acted(now.tick - 1);
    follower_.step(sensors, acting_);
    watch_settling(now.tick);
    watch_misfit();
    if (over()) {
      health_.reset();
    } else {
      health_.take(follower_, sensors, acting_);
    }
    follower_.distrust(health_.distrusted());
    health_due_ = now.tick / health_period_ != before.tick / health_period_;
  }
  sensors_ = sensors;
  offer_early(now.tick);
  mode_before_ = mode_;
  keep_forecast_up();
  return follows();
}

bool Mirror::look_ahead() noexcept {
  if (!portion_due_) return false;
  portion_due_ = false;
  return forecast_.work(follower_);
}

void Mirror::fill(state_t& state) const noexcept {
  state = {};
  state.header = sensors_.header;
  state.mode = mode_;
  const model::Observation seen = machine_.observe(follower_.estimate().state);
  to_wire(seen, follower_.valid() | state_t::VALID_DRIVES, state);
  const auto torques = drive_torques(machine_, seen, sensors_, acting_);
  std::copy(torques.begin(), torques.end(), std::begin(state.drive_torque_nm));
}

void Mirror::fill(health_t& health) const noexcept {
  health = {};
  health_.fill(health);
  if (over()) set_text(health.text, "not judged: the owner is {}", mode_name(mode_));
  health.header = sensors_.header;
  health.header.sequence = sensors_.header.tick / health_period_;
}

}  // namespace gyrotwin
