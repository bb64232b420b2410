#include "services/mirror/service.hpp"

#include "services/runtime/key.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/show_status.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStatusPeriod = kSecond / 10;
constexpr std::int64_t kPatience = kSecond / 2;  // for SENSORS
constexpr std::int64_t kActive = kSecond / 5;    // a TWIN/STATE that recent
constexpr double kBehind = 3.0;                  // ticks

Stamp stamp_of(const header_t& header) {
  return {header.epoch, header.sequence, header.tick, header.sim_time_ns};
}

}  // namespace

MirrorService::MirrorService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon)
    : bus_(bus),
      clock_(clock),
      daemon_(daemon),
      owner_(daemon),
      epoch_(random_id()),
      mirror_(rig),
      behind_(static_cast<std::int64_t>(1e9 * kBehind * rig.loop.tick_s())) {}

void MirrorService::run() noexcept {
  while (daemon_.next_round()) {
    round();
    bus_.wait(status_due_ - clock_.now_ns());
  }
}

/// Forecasting last: where the next SENSORS are there already, there is no time for it.
void MirrorService::round() noexcept {
  listen();
  look_ahead();
  report(clock_.now_ns());
}

void MirrorService::listen() noexcept {
  while (const auto reception = bus_.receive()) {
    if (reception->channel == Channel::kSensors) {
      sensors_t sensors;
      Bus::decode(*reception, sensors);
      on_sensors(sensors);
    } else if (reception->channel == Channel::kState) {
      state_t state;
      Bus::decode(*reception, state);
      mirror_.on_state(state);
    } else if (reception->channel == Channel::kCommand) {
      command_t command;
      Bus::decode(*reception, command);
      mirror_.on_command(command);
    } else if (is_owner_status(reception->channel)) {
      status_t status;
      Bus::decode(*reception, status);
      on_owner(status);
    }
  }
}

/// STATE first, that a controller may wait for.
void MirrorService::on_sensors(const sensors_t& sensors) noexcept {
  const std::int64_t begin = clock_.now_ns();
  if (mirror_.portion_due()) {
    ++left_out_;
    step_.add(spent_);
  }
  if (sensors.header.epoch == mirror_.owner_epoch()) sensors_heard_ = begin;
  if (mirror_.on_sensors(sensors)) {
    state_t state;
    mirror_.fill(state);
    bus_.send(Channel::kTwinState, state, stamp_of(state.header));
    told_ = clock_.now_ns();
    follow_.add(told_ - begin);
    if (same_host()) age_.add(told_ - sensors.header.sender_mono_ns);
  }
  if (mirror_.health_due()) {
    health_t health;
    mirror_.fill(health);
    health.step_p50_ns = step_.p50();
    health.step_max_ns = step_.max();
    bus_.send(Channel::kHealth, health, stamp_of(health.header));
  }
  spent_ = clock_.now_ns() - begin;
  if (!mirror_.portion_due()) step_.add(spent_);
}

void MirrorService::look_ahead() noexcept {
  if (!mirror_.portion_due()) return;
  const std::int64_t begin = clock_.now_ns();
  if (mirror_.look_ahead()) {
    forecast_t forecast;
    mirror_.fill(forecast);
    bus_.send(Channel::kForecast, forecast, stamp_of(forecast.header));
  }
  step_.add(spent_ + clock_.now_ns() - begin);
}

void MirrorService::on_owner(const status_t& status) noexcept {
  owner_.hear(status, clock_.now_ns());
  if (status.header.epoch != mirror_.owner_epoch()) sensors_heard_ = -1;
  mirror_.on_owner(status);
}

/// Stamps of different hosts cannot be compared.
bool MirrorService::same_host() const noexcept {
  return text_view(owner_.last().host) == std::string_view(identity_.host);
}

/// Why it does nothing, or not all.
void MirrorService::explain(status_t& status, std::int64_t now) noexcept {
  const status_t& owner = owner_.last();
  if (status.mode == status_t::MODE_ACTIVE) {
    if (age_.p50() > behind_) {
      set_text(status.text, "behind: TWIN/STATE comes {:.1f} ms after SENSORS; forecasting yields",
               1e-6 * static_cast<double>(age_.p50()));
    }
  } else if (sensors_heard_ < 0 || now - sensors_heard_ >= kPatience) {
    set_text(status.text, "owner {} on {:.24} sends no SENSORS: has its rig file [sensors]?",
             owner.pid, text_view(owner.host));
  } else {
    set_text(status.text, "settling: the owner is {}", mode_name(owner.mode));
  }
}

void MirrorService::report(std::int64_t now) noexcept {
  if (now >= window_due_) {
    follow_.roll();
    step_.roll();
    age_.roll();
    window_due_ = now + kSecond;
  }
  if (now < status_due_) return;
  status_due_ = now + kStatusPeriod;

  status_t status{};
  status.service = status_t::MIRROR;
  const bool active = told_ >= 0 && now - told_ < kActive;
  status.mode = status_t::MODE_WAITING;
  if (active) status.mode = status_t::MODE_ACTIVE;
  if (!owner_.lost(now, status)) explain(status, now);
  fill_process(status, identity_, bus_.counters());
  status.compute_p50_ns = follow_.p50();
  status.compute_p99_ns = follow_.p99();
  status.compute_max_ns = follow_.max();
  status.lateness_p50_ns = age_.p50();
  status.lateness_p99_ns = age_.p99();
  status.lateness_max_ns = age_.max();
  status.overruns = left_out_;
  show_status(daemon_, status);
  bus_.send(
      Channel::kMirrorStatus, status,
      {epoch_, ++status_sequence_, owner_.last().header.tick, owner_.last().header.sim_time_ns});
}

}  // namespace gyrotwin
