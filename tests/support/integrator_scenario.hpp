// A simulated plant in random scenarios: what acts on it and what it answers, step by step against
// owner_model.hpp.
#pragma once

#include <cmath>
#include <optional>

#include "services/integrator/integrator.hpp"
#include "tests/support/owner_scenario.hpp"

namespace gyrotwin::support {

inline OwnerModel::Pace pace_of(const Rig& rig) {
  if (rig.loop.clock == ClockMode::kLockstep) return OwnerModel::Pace::kLockstep;
  return rig.loop.clock == ClockMode::kFree ? OwnerModel::Pace::kFree : OwnerModel::Pace::kRealtime;
}

/// A simulated plant, driven as its service does.
class IntegratorScenario final : public OwnerScenario {
 public:
  IntegratorScenario(std::uint64_t seed, const Rig& rig, Integrator& owner)
      : OwnerScenario(seed, pace_of(rig), rig, owner), owner_(owner) {}

 private:
  void step() override {
    const int action = pick(100);
    if (action < 40) {
      silent_ ? play_back() : command();
    } else if (action < 86) {
      tick();
    } else if (action < 97) {
      ask();
    } else if (action < 98) {
      silent_ = chance(2);
      restart_controller();
    } else {
      trouble();
    }
  }

  void tick() {
    const bool lockstep = pace_of(rig_) == OwnerModel::Pace::kLockstep;
    if (lockstep && model.mode == OwnerModel::kRunning && !link_cut()) {
      require(owner_.answered() == model.answered(),
              "lockstep waits for what has come, or does not");
    }
    if (lockstep && model.mode == OwnerModel::kRunning && !owner_.answered()) return;
    note("advance");
    const bool goes_on = model.goes_on();
    const auto acting = goes_on ? model.begin_tick(link_cut()) : std::nullopt;
    owner_.advance();
    if (!goes_on) return;
    if (owner_.mode() == Mode::kFault) {
      model.event("not finite");
      return;
    }
    model.end_tick();
    check_drives(acting);
    const GroundedPlant& plant = owner_.plant();
    if (plant.machine().tilt(plant.state()) > rig_.safety.fall_tilt_rad) model.event("tilt");
    model.count_step();
  }

  /// What acted in the last tick is what was commanded, or nothing (safe_stop = "zero_torque").
  void check_drives(const std::optional<command_t>& acting) {
    const TickRecord* last = nullptr;
    owner_.visit_history([&](const TickRecord& record) { last = &record; });
    require(last != nullptr && last->tick == model.tick - 1, "the history lacks the last tick");
    state_t state{};
    owner_.fill(state);
    const model::Machine& machine = owner_.plant().machine();
    for (std::size_t i = 0; i < machine.drives.size(); ++i) {
      const double asked = acting ? acting->value[i] : 0.0;
      require(last->input.drive[i] == asked,
              acting ? "another torque acts than the last one that was obeyed"
                     : "a torque acts that nobody may command");
      require(!acting || (last->input.mode == model::DriveMode::kVoltage) ==
                             (acting->mode == command_t::VOLTAGE_V),
              "the command acts in another unit");
      require(std::abs(state.drive_torque_nm[i]) <= machine.drives[i].torque_limit + 1e-9,
              "a torque is beyond the drive's limit");
    }
    torques_ += acting ? 1 : 0;
  }

  /// The machine stands where it is put; most requests are those that go on.
  void ask() {
    Surroundings around{.controller_heard = !chance(10),
                        .other_owner_heard = chance(20),
                        .fresh_epoch = fresh_epoch()};
    request_t r{};
    std::int32_t verb = pick(request_t::FAULT + 3) - 1;
    if (model.mode == OwnerModel::kHeld && chance(2)) verb = request_t::ARM;
    if (model.mode >= OwnerModel::kSafeStop && chance(3)) verb = request_t::RESET;
    if (model.mode == OwnerModel::kRunning && verb == request_t::RESET && !chance(8)) return;
    r.step_ticks = pick(5) * (pick(5) - 1);
    r.speed_factor = 0.5 * pick(4);
    r.id = pick(20);
    r.duration_ns = 1'000'000LL * pick(50);
    if (verb == request_t::DISTURB) {
      r.kind = request_t::LOAD;
      r.moment_nm[0] = 400.0 * (pick(3) - 1);
    }
    if (verb == request_t::FAULT) r.kind = request_t::COMMAND_LOST;
    if (verb == request_t::ROTORS) r.kind = pick(4);
    request(verb, around, r);
  }

  void trouble() {
    switch (pick(3)) {
      case 0:
        note("another owner");
        owner_.notice(Event::kConflict, "");
        model.event("conflict");
        break;
      case 1:
        note("overrun");
        owner_.notice(Event::kOverrun, "");
        model.event("overrun");
        break;
      default:
        wait();
    }
  }

  /// Lockstep: 2 s without an answer, or the answer after that.
  void wait() {
    if (pace_of(rig_) != OwnerModel::Pace::kLockstep) return;
    if (model.mode == OwnerModel::kRunning && !owner_.answered()) {
      note("no controller");
      owner_.notice(Event::kNoController, "");
      model.event("no controller");
    }
    require(owner_.waiting_for_controller() == model.waits_for_controller(),
            "it waits for the controller, or does not");
    if (model.waits_for_controller() && owner_.answered()) {
      note("controller back");
      owner_.notice(Event::kControllerBack, "");
      model.event("controller back");
    }
  }

  Expected expect(const request_t& r, const Surroundings& around) override {
    const auto yes = [](bool must) { return must ? Expected::kApplied : Expected::kRefused; };
    const bool controller = around.controller_heard || pace_of(rig_) == OwnerModel::Pace::kFree;
    switch (r.verb) {
      case request_t::ARM:
        return yes(model.mode == OwnerModel::kHeld && controller && !around.other_owner_heard);
      case request_t::DISARM:
        return yes(model.mode == OwnerModel::kRunning || model.mode == OwnerModel::kPaused);
      case request_t::PAUSE:
        return yes(model.mode == OwnerModel::kRunning);
      case request_t::RESUME:
        return yes(model.mode == OwnerModel::kPaused);
      case request_t::STEP:
        return yes(model.mode == OwnerModel::kPaused && r.step_ticks >= 1);
      case request_t::RESET:
        return Expected::kApplied;
      case request_t::SPEED:
      case request_t::DISTURB:
      case request_t::FAULT:
      case request_t::CANCEL:
      case request_t::CLEAR:
      case request_t::ROTORS:
        return Expected::kEither;  // whose rules are schedule's; none of them changes the mode
      default:
        return Expected::kRefused;
    }
  }

  void applied(const request_t& r, const Surroundings& around) override {
    if (r.verb == request_t::ARM) model.event("arm");
    if (r.verb == request_t::DISARM) model.event("disarm");
    if (r.verb == request_t::PAUSE) model.event("pause");
    if (r.verb == request_t::RESUME) model.event("resume");
    if (r.verb == request_t::STEP) model.step(r.step_ticks);
    if (r.verb == request_t::RESET) model.reset(around.fresh_epoch);
  }

  bool link_cut() const override { return owner_.command_link_cut(); }
  void fill(status_t& status) const override { owner_.fill(status); }

  Integrator& owner_;
  bool silent_ = false;  // the controller
};

}  // namespace gyrotwin::support
