// A real plant's owner in random scenarios: what goes down the line and what it answers, step by
// step against owner_model.hpp.
#pragma once

#include <cmath>
#include <map>
#include <utility>

#include "services/hardware/hardware.hpp"
#include "tests/support/owner_scenario.hpp"

namespace gyrotwin::support {

/// A real plant's device as a few messages, and its owner, driven as its service does.
class HardwareScenario final : public OwnerScenario {
 public:
  HardwareScenario(std::uint64_t seed, const Rig& rig, Hardware& owner)
      : OwnerScenario(seed, OwnerModel::Pace::kRealtime, rig, owner), owner_(owner) {
    for (const std::int32_t sensor :
         {+sensors_t::VALID_GYRO, +sensors_t::VALID_ACCELEROMETER, +sensors_t::VALID_DISC,
          +sensors_t::VALID_GIMBALS, +sensors_t::VALID_ROTORS, +sensors_t::VALID_ESTOP}) {
      sample_.valid |= sensor;
    }
    sample_.header.epoch = 99;
    owner_.set_connected(true);
    lean(0.01);
    warm_up();
  }

 private:
  static constexpr std::int64_t kPatience = 500'000'000;  // for the device's answer [ns]

  void step() override {
    now_ += 300'000;
    const int action = pick(100);
    if (action < 40) {
      silent_ ? play_back() : command();
      take();
    } else if (action < 80) {
      sample();
    } else if (action < 90) {
      ask();
    } else if (action < 96) {
      beat();
    } else if (action < 97) {
      silent_ = chance(3);
      restart_controller();
    } else {
      trouble();
    }
    answer();
  }

  /// What goes down the line: the last command that was obeyed, within limits, while RUNNING.
  void take() {
    const auto out = owner_.take_command();
    const bool due = heard_.has_value() && model.mode == OwnerModel::kRunning;
    require(out.has_value() == due, due ? "a good command does not reach the device"
                                        : "a command reaches the device that nobody may give");
    if (out) {
      const double limit = owner_limit();
      require(out->mode == heard_->mode && out->writer == heard_->writer &&
                  out->counter == heard_->counter,
              "another command reaches the device");
      const double asked = heard_->value[0];
      require(std::isfinite(out->value[0]) && std::abs(out->value[0]) <= std::abs(asked) + 1e-9,
              "the device is asked for more than was commanded");
      require(out->mode != command_t::TORQUE_NM || std::abs(out->value[0]) <= limit,
              "the device is asked for more than the drive's limit");
      require(out->valid_ticks == heard_->for_tick + heard_->valid_ticks - model.tick &&
                  out->valid_ticks >= 1,
              "a command lasts longer on the device than it was given");
      ++torques_;
    }
    heard_.reset();
  }

  double owner_limit() const { return limit_; }

  void sample(std::int64_t gone = 1) {
    if (chance(50)) gone += pick(4);
    sample_.header.tick += gone;
    sample_.header.sim_time_ns += gone * rig_.loop.tick_ns();
    note("sample after {}{}{}", gone, sample_.estop ? ", E-stop" : "", leaning_ ? ", leaning" : "");
    if (sample_.header.epoch != heard_epoch_) new_device();
    if (!std::exchange(known_tick_, true)) gone = 1;  // what went before it nobody knows
    owner_.on_sample(sample_);
    if (model.goes_on()) model.end_tick(gone);
    if (sample_.estop != 0) stopped(model.event("E-stop"));
    if (model.mode == OwnerModel::kRunning && model.lost()) stopped(model.event("command lost"));
    // Its estimate of the tilt is the estimator's; that something leans is known here.
    if (owner_.mode() == Mode::kFallen && leaning_) model.event("tilt");
    if (chance(100)) {
      const std::int64_t tick = owner_.tick();
      require(!owner_.on_sample(sample_) && owner_.tick() == tick, "a repeated sample is a tick");
    }
  }

  void beat() {
    beat_t beat{};
    beat.header.epoch = sample_.header.epoch;
    device_mode_ = model.mode;
    if (chance(8)) device_mode_ = pick(4);
    beat.mode = device_mode_;
    note("beat {}", beat.mode);
    if (sample_.header.epoch != heard_epoch_) new_device();
    const bool runs = model.mode == OwnerModel::kRunning;
    owner_.on_beat(beat);
    if (!runs) return;
    if (beat.mode == status_t::MODE_RUNNING) idle_beats_ = 0;
    const bool idle = beat.mode != status_t::MODE_RUNNING;
    if (beat.mode == status_t::MODE_SAFE_STOP || (idle && ++idle_beats_ > 10)) {
      stopped(model.event("device stopped"));
    }
    beat_t to_device{};
    owner_.fill(to_device);
    require(to_device.mode == model.mode, "the device is told another mode");
  }

  void trouble() {
    switch (pick(8)) {
      case 0:
        note("another owner");
        owner_.notice(Event::kConflict, "");
        stopped(model.event("conflict"));
        break;
      case 1:
        note("line silent");
        owner_.notice(Event::kDeviceLost, "");
        stopped(model.event("device lost"));
        owner_.set_connected(connected_ = chance(2));
        break;
      case 2:
        note("line back");
        owner_.set_connected(connected_ = true);
        break;
      case 3:
        sample_.estop = 1;
        sample();
        break;
      case 4:
        if (!chance(8)) break;
        ++sample_.header.epoch;
        sample_.header.tick = pick(1000);
        sample();
        warm_up();
        break;
      case 5:
        if (!chance(8)) break;
        lean(2.0);
        for (int i = 0; i < 400; ++i) sample();
        lean(0.01);
        break;
      default:
        sample_.estop = 0;
        sample();
    }
  }

  /// Until its rate and its tilt are known.
  void warm_up() {
    for (int i = 0; i < 600; ++i) sample();
  }

  void lean(double roll) {
    leaning_ = leaning_ || roll > 1.0;
    sample_.acceleration_m_s2[1] = 9.81 * std::sin(roll);
    sample_.acceleration_m_s2[2] = 9.81 * std::cos(roll);
  }

  void new_device() {
    known_tick_ = false;
    if (heard_epoch_ >= 0) stopped(model.event("device stopped"));
    heard_epoch_ = sample_.header.epoch;
  }

  /// What was commanded and has not gone down the line never does.
  void stopped(bool has) {
    if (!has) return;
    heard_.reset();
  }

  void ask() {
    Surroundings around{.controller_heard = !chance(10),
                        .other_owner_heard = chance(20),
                        .fresh_epoch = fresh_epoch()};
    request_t r{};
    std::int32_t verb = pick(request_t::FAULT + 3) - 1;
    if (model.mode == OwnerModel::kHeld && chance(2)) verb = request_t::ARM;
    if (model.mode >= OwnerModel::kSafeStop && chance(3)) verb = request_t::RESET;
    if (model.mode == OwnerModel::kRunning && verb == request_t::RESET && !chance(8)) return;
    r.initial_given = chance(10) ? 1 : 0;
    r.kind = pick(4);
    request(verb, around, r);
  }

  Expected expect(const request_t& r, const Surroundings& around) override {
    switch (r.verb) {
      case request_t::ARM:
        // It must know its device, too: that is hardware_test's.
        return model.mode == OwnerModel::kHeld && around.controller_heard &&
                       !around.other_owner_heard && connected_ && sample_.estop == 0
                   ? Expected::kEither
                   : Expected::kRefused;
      case request_t::DISARM:
        return model.mode == OwnerModel::kRunning ? Expected::kApplied : Expected::kRefused;
      case request_t::RESET:
        return sample_.estop == 0 && r.initial_given == 0 ? Expected::kApplied : Expected::kRefused;
      case request_t::ROTORS:
      case request_t::DISTURB:
      case request_t::FAULT:
      case request_t::CANCEL:
      case request_t::CLEAR:
        return Expected::kEither;
      default:
        return Expected::kRefused;
    }
  }

  void applied(const request_t& r, const Surroundings& around) override {
    if (r.verb == request_t::ARM) {
      model.event("arm");
      idle_beats_ = 0;
    }
    if (r.verb == request_t::DISARM) stopped(model.event("disarm"));
    if (r.verb == request_t::RESET) {
      model.reset(around.fresh_epoch);
      heard_.reset();
      leaning_ = false;
    }
  }

  void deferred(const request_t& r) override {
    const auto key = std::pair(r.writer, r.counter);
    waiting_.try_emplace(key, now_);
  }

  /// Every request that was left for later is answered, once: by the device, or for it.
  void answer() {
    reply_t reply{};
    while (const auto request = owner_.take_request()) {
      if (chance(3)) continue;  // the line, or the device, loses it
      reply_t answer{};
      answer.request_writer = request->writer;
      answer.request_counter = request->counter;
      answer.result = pick(3);
      answer.id = pick(3);
      set_text(answer.text, "the device says so");
      require(owner_.on_reply(answer, reply), "the device's answer goes nowhere");
      settle(reply);
      require(!owner_.on_reply(answer, reply), "an answer is given twice");
    }
    while (owner_.overdue(now_, reply)) {
      require(reply.result == reply_t::REFUSED, "silence counts as a yes");
      settle(reply);
    }
    for (const auto& [key, since] : waiting_) {
      require(now_ - since <= kPatience + 1'000'000, "a request is never answered");
    }
  }

  void settle(const reply_t& reply) {
    require(waiting_.erase(std::pair(reply.request_writer, reply.request_counter)) == 1,
            "an answer to what nobody has asked, or a second one");
    answered_later(reply);
  }

  void fill(status_t& status) const override { owner_.fill(status); }

  Hardware& owner_;
  sensors_t sample_{};
  std::int64_t now_ = 1, heard_epoch_ = -1;
  std::int32_t device_mode_ = 0;
  int idle_beats_ = 0;
  bool silent_ = false, connected_ = true, leaning_ = false;
  bool known_tick_ = false;  // of the device
  const double limit_ = rig_.build_machine().drives[0].torque_limit;
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> waiting_;  // asked at [ns]
};

}  // namespace gyrotwin::support
