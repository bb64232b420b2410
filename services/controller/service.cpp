#include "services/controller/service.hpp"

#include "services/runtime/key.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig_bus.hpp"
#include "services/runtime/show_status.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStatusPeriod = kSecond / 10;
constexpr std::int64_t kActive = kSecond / 5;  // a COMMAND that recent

}  // namespace

ControllerService::ControllerService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon,
                                     Feedback on)
    : bus_(bus),
      clock_(clock),
      daemon_(daemon),
      owner_(daemon),
      epoch_(random_id()),
      controller_(rig, random_id()),
      on_(on) {}

void ControllerService::run() noexcept {
  std::int64_t now = clock_.now_ns();
  while (daemon_.next_round()) {
    const auto reception = bus_.receive(status_due_ - now);
    now = clock_.now_ns();
    if (reception) hear(*reception, now);
    report(now);
  }
}

void ControllerService::hear(const Reception& reception, std::int64_t now) noexcept {
  const Channel answered = on_ == Feedback::kTwin ? Channel::kTwinState : Channel::kState;
  if (reception.channel == answered) {
    state_t state;
    Bus::decode(reception, state);
    on_state(state, now);
  } else if (is_owner_status(reception.channel)) {
    status_t status;
    Bus::decode(reception, status);
    on_owner(status, now);
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
  owner_.hear(status, now);
  if (status.header.epoch != controller_.owner_epoch()) epoch_ = random_id();
  controller_.on_owner(status);
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
  if (owner_.lost(now, status)) {
    // Its text says so.
  } else if (twin_lost(now)) {
    set_text(status.text, "no TWIN/STATE is heard, so no commands: start gyrotwin-mirror");
    if (!said_twin_lost_) daemon_.log(LogLevel::kWarning, "the twin is silent: no more commands");
    said_twin_lost_ = true;
  } else if (!active) {
    set_text(status.text, "the owner is {}", mode_name(owner_.last().mode));
  }
  fill_process(status, identity_, bus_.counters());
  status.compute_p50_ns = compute_.p50();
  status.compute_p99_ns = compute_.p99();
  status.compute_max_ns = compute_.max();
  show_status(daemon_, status);
  const header_t& owner = owner_.last().header;
  bus_.send(Channel::kControllerStatus, status,
            {epoch_, ++status_sequence_, owner.tick, owner.sim_time_ns});
}

}  // namespace gyrotwin
