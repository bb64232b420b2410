// What an owner has to do with commands, requests and time: the rules of messages/README.md and of
// `gyrotwin ctl modes` stated once more, plainly, for random tests to hold the owners against. It
// shares no code with them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>

#include "messages/channels.hpp"

namespace gyrotwin::support {

class OwnerModel {
 public:
  enum class Pace { kRealtime, kLockstep, kFree };
  enum Mode : std::int32_t {
    kHeld = status_t::MODE_HELD,
    kRunning = status_t::MODE_RUNNING,
    kPaused = status_t::MODE_PAUSED,
    kSafeStop = status_t::MODE_SAFE_STOP,
    kFallen = status_t::MODE_FALLEN,
    kFault = status_t::MODE_FAULT,
  };

  OwnerModel(Pace pace, int timeout_ticks, std::int64_t first_epoch)
      : pace_(pace), timeout_(timeout_ticks), epoch(first_epoch) {}

  Mode mode = kHeld;
  std::int64_t tick = 0;

  // Commands refused, each under the first rule that it breaks.
  std::int64_t not_finite = 0, other_epoch = 0, expired = 0, other_writer = 0, old_counter = 0;

  /// A command that is authentic.
  /// @param link_cut a fault keeps commands from acting
  /// @return whether it is obeyed
  bool command(const command_t& c, bool link_cut) {
    if (mode != kRunning && mode != kPaused) return false;
    if (link_cut) {
      if (c.owner_epoch == epoch && c.for_tick == tick) answered_ = true;
      return false;
    }
    const bool known = c.mode == command_t::TORQUE_NM || c.mode == command_t::VOLTAGE_V;
    if (!known || c.valid_ticks < 1 ||
        !std::ranges::all_of(c.value, [](double x) { return std::isfinite(x); })) {
      return refused(not_finite);
    }
    if (c.owner_epoch != epoch) return refused(other_epoch);
    const bool of_this_run = c.for_tick >= 0 && c.for_tick <= tick;
    if (!of_this_run || tick - c.for_tick >= c.valid_ticks) return refused(expired);
    if (lease_ && *lease_ != c.writer && !lost()) return refused(other_writer);
    const auto served = served_.find(c.writer);
    if (served != served_.end() && c.counter <= served->second) return refused(old_counter);

    lease_ = c.writer;
    served_[c.writer] = c.counter;
    heard_ = tick;
    obeyed_ = c;
    if (c.for_tick == tick) answered_ = true;
    return true;
  }

  /// No valid command for the rig's timeout.
  bool lost() const { return tick - heard_ >= timeout_; }
  /// The command for this tick has come.
  bool answered() const { return answered_; }
  bool goes_on() const { return mode == kRunning || mode == kSafeStop || mode == kFallen; }
  bool waits_for_controller() const { return waiting_; }

  /// A tick begins. @return the command that acts in it, if one does
  std::optional<command_t> begin_tick(bool link_cut) {
    const bool counts = pace_ == Pace::kRealtime || (pace_ == Pace::kLockstep && link_cut);
    if (counts && lost()) event("command lost");
    if (mode != kRunning || !obeyed_ || tick - obeyed_->for_tick >= obeyed_->valid_ticks) return {};
    return obeyed_;
  }
  /// It is over, and so many ticks have gone by.
  void end_tick(std::int64_t ticks = 1) {
    tick += ticks;
    answered_ = false;
  }
  void count_step() {
    if (steps_ > 0 && --steps_ == 0) event("steps done");
  }

  /// @return whether it means something in this mode
  bool event(std::string_view name) {
    const std::optional<Mode> to = way(name);
    if (!to) return false;
    // A step that waits for the controller goes on with it.
    if (name != "step" && name != "no controller" && name != "controller back") steps_ = 0;
    waiting_ = name == "no controller";
    if (waiting_) lease_.reset();
    mode = *to;
    return true;
  }
  bool step(std::int64_t ticks) {
    if (!event("step")) return false;
    steps_ = ticks;
    return true;
  }
  void reset(std::int64_t fresh_epoch) {
    event("reset");
    epoch = fresh_epoch;
    tick = heard_ = 0;
    answered_ = false;
    lease_.reset();
    served_.clear();
    obeyed_.reset();
  }

 private:
  static bool refused(std::int64_t& counter) {
    ++counter;
    return false;
  }

  std::optional<Mode> way(std::string_view event) const {
    const auto from = [this](auto... modes) { return ((mode == modes) || ...); };
    const auto is = [event](auto... names) { return ((event == names) || ...); };
    if (is("reset")) return kHeld;
    if (is("arm") && from(kHeld)) return kRunning;
    if (is("pause", "steps done", "no controller") && from(kRunning)) return kPaused;
    if (is("resume", "step", "controller back") && from(kPaused)) return kRunning;
    if (is("disarm", "conflict") && from(kRunning, kPaused)) return kSafeStop;
    if (is("command lost", "overrun", "E-stop", "device lost", "device stopped") &&
        from(kRunning)) {
      return kSafeStop;
    }
    if (is("tilt") && from(kRunning, kSafeStop)) return kFallen;
    if (is("not finite") && from(kRunning, kSafeStop, kFallen)) return kFault;
    return {};
  }

  Pace pace_;
  std::int64_t timeout_;
  std::int64_t heard_ = 0;  // the tick in which a command was last obeyed
  bool answered_ = false;
  std::optional<std::int64_t> lease_;
  std::map<std::int64_t, std::int64_t> served_;  // last counter of each writer, in this run
  std::optional<command_t> obeyed_;              // last
  std::int64_t steps_ = 0;                       // of STEP, left
  bool waiting_ = false;

 public:
  std::int64_t epoch;
};

}  // namespace gyrotwin::support
