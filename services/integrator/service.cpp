#include "services/integrator/service.hpp"

#include "services/runtime/key.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStatusPeriod = kSecond / 10;
constexpr std::int64_t kRepeat = 20 * kMillisecond;  // STATE while time stands still
constexpr std::int64_t kPatience = 2 * kSecond;      // lockstep: then "waiting for controller"
constexpr std::int64_t kLongestSleep =
    10 * kMillisecond;  // then it listens, however long a tick is

std::int32_t pace(ClockMode clock) {
  switch (clock) {
    case ClockMode::kLockstep:
      return status_t::PACE_LOCKSTEP;
    case ClockMode::kFree:
      return status_t::PACE_FREE;
    case ClockMode::kRealtime:
      break;
  }
  return status_t::PACE_REALTIME;
}

/// Who waits for answers has no deadline to spin for.
std::int64_t spin_of(const Rig::Loop& loop) {
  return loop.clock == ClockMode::kLockstep ? 0 : 1000 * std::int64_t{loop.spin_us};
}

}  // namespace

IntegratorService::IntegratorService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon)
    : rig_(rig),
      bus_(bus),
      clock_(clock),
      daemon_(daemon),
      integrator_(rig, random_id()),
      desk_(bus, daemon, integrator_, Channel::kIntegratorStatus),
      pacer_(rig.loop.tick_ns(), rig.loop.overrun, spin_of(rig.loop)) {}

void IntegratorService::run() noexcept {
  publish(clock_.now_ns());
  while (daemon_.next_round()) {
    const std::int64_t now = clock_.now_ns();
    listen(now);
    follow_pace(now);
    if (must_tick(now)) tick(now);
    follow_mode(now);
    report(now);
    rest(clock_.now_ns());
  }
}

/// Whether wall time makes the ticks; in lockstep the controller's answers do.
bool IntegratorService::paced() const noexcept {
  const Mode mode = integrator_.mode();
  return ticks(mode) && !(mode == Mode::kRunning && rig_.loop.clock == ClockMode::kLockstep);
}

/// Machines pause programs, by turns, for longer than a timeout of a few ticks. A simulated plant
/// can stand still meanwhile: the timeout in ticks stays what it is, and the lost time is counted.
bool IntegratorService::bridges_pause(std::int64_t now) const noexcept {
  return integrator_.command_lost() && !integrator_.command_link_cut() &&
         now - obeyed_at_ < rig_.loop.patience_ns();
}

/// Where wall time begins to make the ticks, or goes on to, the next one is a period away.
void IntegratorService::follow_pace(std::int64_t now) noexcept {
  if (integrator_.speed() != pacer_.speed()) pacer_.set_speed(integrator_.speed(), now);
  if (paced() && !was_paced_) pacer_.anchor(now);
  was_paced_ = paced();
  const bool bridging = bridges_pause(now);
  if (was_bridging_ && !bridging) pacer_.give_up_until(now);
  was_bridging_ = bridging;
}

bool IntegratorService::must_tick(std::int64_t now) const noexcept {
  if (bridges_pause(now)) return false;
  if (paced()) return now >= pacer_.deadline();
  return ticks(integrator_.mode()) && integrator_.answered();
}

void IntegratorService::tick(std::int64_t now) noexcept {
  if (paced() && !pacer_.begin(now)) {
    integrator_.notice(Event::kOverrun, "a tick overran and loop.overrun is stop");
  }
  integrator_.advance();
  publish(now);
  pacer_.worked(clock_.now_ns() - now);
}

/// Sleeps until there is something to do.
void IntegratorService::rest(std::int64_t now) noexcept {
  if (paced() && !bridges_pause(now)) {
    // Whose work has taken the time to sleep does not spin in addition: every round sleeps.
    if (now >= pacer_.wake()) return clock_.sleep_until(pacer_.deadline());
    clock_.sleep_until(std::min(pacer_.wake(), now + kLongestSleep));
    if (clock_.now_ns() >= pacer_.wake()) clock_.spin_until(pacer_.deadline());
    return;
  }
  await_controller(now);
  if (now - sent_at_ >= kRepeat) repeat_state(now);
  bus_.wait(std::min(sent_at_ + kRepeat - now, kLongestSleep));
}

void IntegratorService::await_controller(std::int64_t now) noexcept {
  const bool lockstep = rig_.loop.clock == ClockMode::kLockstep;
  if (lockstep && integrator_.mode() == Mode::kRunning && now - asked_at_ >= kPatience) {
    integrator_.notice(Event::kNoController, "waiting for controller");
    follow_mode(now);
  }
}

void IntegratorService::listen(std::int64_t now) noexcept {
  while (const auto reception = bus_.receive()) {
    if (desk_.hear(*reception, now)) obeyed_at_ = now;
    follow_mode(now);
    desk_.answer();
  }
  if (integrator_.waiting_for_controller() && integrator_.answered()) {
    integrator_.notice(Event::kControllerBack, "");
  }
}

/// The present tick's messages, for the first time.
void IntegratorService::publish(std::int64_t now) noexcept {
  integrator_.fill(state_);
  integrator_.fill(truth_);
  integrator_.fill(sensors_);
  stamp_ = {integrator_.epoch(), integrator_.sequence(), integrator_.tick(),
            integrator_.sim_time_ns()};
  asked_at_ = now;
  send_state(now);
}

void IntegratorService::send_state(std::int64_t now) noexcept {
  bus_.send(Channel::kState, state_, stamp_);
  bus_.send(Channel::kTruth, truth_, stamp_);
  if (integrator_.has_sensors()) bus_.send(Channel::kSensors, sensors_, stamp_);
  sent_at_ = now;
}

/// While time stands still; rotors may run meanwhile.
void IntegratorService::repeat_state(std::int64_t now) noexcept {
  if (integrator_.hold(1e-9 * static_cast<double>(kRepeat) * integrator_.speed())) {
    publish(now);
  } else {
    send_state(now);
  }
}

/// A new mode or run is said at once.
void IntegratorService::follow_mode(std::int64_t now) noexcept {
  const Mode mode = integrator_.mode();
  const bool new_run = integrator_.epoch() != stamp_.epoch;
  if (mode == followed_mode_ && !new_run) return;
  followed_mode_ = mode;
  asked_at_ = obeyed_at_ = now;
  publish_status(now);
  daemon_.log(mode == Mode::kFault ? LogLevel::kError : LogLevel::kInfo, "{} at tick {}{}{}",
              name_of(mode), integrator_.tick(), integrator_.why().empty() ? "" : ": ",
              integrator_.why());
  // A controller answers what says RUNNING; the last STATE of a step, which it is asked for now,
  // says PAUSED.
  const bool asks = mode == Mode::kRunning && !integrator_.answered();
  if (new_run || integrator_.sequence() != stamp_.sequence || asks) publish(now);
  if (mode == Mode::kFault) log_history();
}

void IntegratorService::publish_status(std::int64_t now) noexcept {
  status_t status{};
  integrator_.fill(status);
  status.clock = pace(rig_.loop.clock);
  if (status.text[0] == 0 && was_bridging_) set_text(status.text, "waiting for a command");
  fill_loop(status, pacer_);
  desk_.send_status(status, now);
}

/// STATUS at its rate, statistics at theirs.
void IntegratorService::report(std::int64_t now) noexcept {
  if (now >= window_due_) {
    pacer_.lateness().roll();
    pacer_.compute().roll();
    window_due_ = now + kSecond;
  }
  if (now < status_due_) return;
  status_due_ = now + kStatusPeriod;
  publish_status(now);
}

void IntegratorService::log_history() noexcept {
  integrator_.visit_history([this](const TickRecord& record) {
    const auto& q = record.state.q;
    const auto& v = record.state.v;
    daemon_.log(LogLevel::kError,
                "tick {}: q {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} v {:.6g} "
                "{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} drive {:.6g} {:.6g}",
                record.tick, q[0], q[1], q[2], q[3], q[4], q[5], v[0], v[1], v[2], v[3], v[4], v[5],
                record.input.drive[0], record.input.drive[1]);
  });
}

}  // namespace gyrotwin
