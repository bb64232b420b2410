#include "services/controller/service.hpp"

#include "services/runtime/key.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStatusPeriod = kSecond / 10;
constexpr std::int64_t kOwnerPatience = kSecond / 2;  // five STATUS messages missing
constexpr std::int64_t kActive = kSecond / 5;         // a COMMAND that recent

}  // namespace

ControllerService::ControllerService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon,
                                     Feedback on)
    : bus_(bus),
      clock_(clock),
      daemon_(daemon),
      epoch_(random_id()),
      controller_(rig, random_id()),
      on_(on) {}

void ControllerService::run() noexcept {
  while (!daemon_.stopping()) {
    const std::int64_t now = clock_.now_ns();
    listen(now);
    report(clock_.now_ns());
    bus_.wait(status_due_ - clock_.now_ns());
  }
}

void ControllerService::listen(std::int64_t now) noexcept {
  const Channel answered = on_ == Feedback::kTwin ? Channel::kTwinState : Channel::kState;
  while (const auto reception = bus_.receive()) {
    if (reception->channel == answered) {
      state_t state;
      Bus::decode(*reception, state);
      on_state(state, now);
    } else if (is_owner_status(reception->channel)) {
      status_t status;
      Bus::decode(*reception, status);
      on_owner(status, now);
    }
  }
}

void ControllerService::on_state(const state_t& state, std::int64_t now) noexcept {
  state_heard_ = now;
  said_twin_lost_ = false;
  command_t command;
  if (!controller_.answer(state, command)) return;
  bus_.send(Channel::kCommand, command,
            {epoch_, state.header.sequence, state.header.tick, state.header.sim_time_ns});
  answered_at_ = now;
  compute_.add(clock_.now_ns() - now);
}

void ControllerService::on_owner(const status_t& status, std::int64_t now) noexcept {
  if (said_lost_ || status.header.epoch != owner_.header.epoch || status.mode != owner_.mode) {
    daemon_.log(LogLevel::kInfo, "owner {} on {}: {} {}", status.pid, text_view(status.host),
                mode_name(status.mode), text_view(status.text));
  }
  if (status.header.epoch != controller_.owner_epoch()) epoch_ = random_id();
  said_lost_ = false;
  owner_ = status;
  owner_heard_ = now;
  controller_.on_owner(status);
}

bool ControllerService::owner_lost(std::int64_t now) const noexcept {
  return owner_heard_ < 0 || now - owner_heard_ > kOwnerPatience;
}

/// Nothing takes its place: without commands the owner stops safely.
bool ControllerService::twin_lost(std::int64_t now) const noexcept {
  return on_ == Feedback::kTwin && (state_heard_ < 0 || now - state_heard_ > kActive);
}

void ControllerService::report(std::int64_t now) noexcept {
  if (now >= window_due_) {
    compute_.roll();
    window_due_ = now + kSecond;
  }
  if (now < status_due_) return;
  status_due_ = now + kStatusPeriod;

  status_t status{};
  status.service = status_t::CONTROLLER;
  const bool active = answered_at_ >= 0 && now - answered_at_ < kActive;
  status.mode = status_t::MODE_WAITING;
  if (active) status.mode = status_t::MODE_ACTIVE;
  if (owner_lost(now)) {
    set_text(status.text, "no owner is heard: start gyrotwin-integrator with the same rig file");
    if (!said_lost_) daemon_.log(LogLevel::kWarning, "the owner is silent");
    said_lost_ = true;
  } else if (twin_lost(now)) {
    set_text(status.text, "no TWIN/STATE is heard, so no commands: start gyrotwin-mirror");
    if (!said_twin_lost_) daemon_.log(LogLevel::kWarning, "the twin is silent: no more commands");
    said_twin_lost_ = true;
  } else if (!active) {
    set_text(status.text, "the owner is {}", mode_name(owner_.mode));
  }
  fill_process(status, identity_, bus_.counters());
  status.compute_p50_ns = compute_.p50();
  status.compute_p99_ns = compute_.p99();
  status.compute_max_ns = compute_.max();
  bus_.send(Channel::kControllerStatus, status,
            {epoch_, ++status_sequence_, owner_.header.tick, owner_.header.sim_time_ns});
}

}  // namespace gyrotwin
