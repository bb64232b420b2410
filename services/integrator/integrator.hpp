// The owner of a simulated plant: modes, commands, requests and physics, tick by tick. Pure: it
// sees neither bus nor clock; services/integrator/service.hpp wires it to both.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "messages/channels.hpp"
#include "services/integrator/disturbances.hpp"
#include "services/integrator/plant.hpp"
#include "services/runtime/command_gate.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// What the wiring knows about the others on the bus when a request comes.
struct Surroundings {
  bool controller_heard = false;   ///< within the last second
  bool other_owner_heard = false;  ///< within the last second
  std::int64_t fresh_epoch = 0;    ///< random; taken by a reset
};

/// What acted in a tick and where it led; the last ones are logged on a fault.
struct TickRecord {
  std::int64_t tick;
  model::State state;  ///< before the tick
  model::Input input;
};

/// Last counters of those who have asked, so that a request recorded on the network and sent again
/// does nothing. The longest silent one is forgotten first.
class Askers {
 public:
  /// Whether this writer has not used this counter or a higher one; remembers it.
  bool newer(std::int64_t writer, std::int64_t counter) noexcept {
    auto asker = std::find_if(askers_.begin(), askers_.end(),
                              [writer](const Asker& a) { return a.used && a.writer == writer; });
    if (asker != askers_.end() && counter <= asker->counter) return false;
    if (asker == askers_.end()) asker = askers_.end() - 1;
    std::move_backward(askers_.begin(), asker, asker + 1);
    askers_.front() = {writer, counter, true};
    return true;
  }

 private:
  struct Asker {
    std::int64_t writer = 0, counter = 0;
    bool used = false;
  };
  std::array<Asker, 64> askers_;
};

class Integrator {
 public:
  /// HELD at the rig's initial state.
  /// @param rig outlives the integrator
  /// @param epoch random, of the first run
  Integrator(const Rig& rig, std::int64_t epoch);

  /// @return whether the command is accepted
  bool on_command(const command_t& command) noexcept;
  /// Does what is asked, or not; fills everything of `reply` but header and mac. A request that was
  /// answered already (same writer and counter) gets the same answer and is not done again.
  void on_request(const request_t& request, const Surroundings& surroundings,
                  reply_t& reply) noexcept;
  /// Something noticed on the bus or in the loop; `why` is shown in STATUS.
  void notice(Event event, std::string_view why) noexcept;

  /// Runs one tick if time goes on in this mode.
  void advance() noexcept;

  Mode mode() const noexcept { return mode_; }
  std::int64_t tick() const noexcept { return tick_; }
  std::int64_t epoch() const noexcept { return epoch_; }
  double speed() const noexcept { return speed_; }
  /// The command for the present tick has come (lockstep).
  bool answered() const noexcept { return gate_.answered(tick_); }
  /// The next advance() would be a safe stop for want of commands (realtime).
  bool command_lost() const noexcept {
    return mode_ == Mode::kRunning && rig_.loop.clock == ClockMode::kRealtime && gate_.lost(tick_);
  }
  /// Stands still until the controller answers (lockstep).
  bool waiting_for_controller() const noexcept { return waiting_for_controller_; }
  const Plant& plant() const noexcept { return plant_; }

  /// STATE's and TRUTH's sequence: 0 while HELD, then tick + 1; the same run gives the same
  /// numbers.
  std::int64_t sequence() const noexcept { return mode_ == Mode::kHeld ? 0 : tick_ + 1; }
  std::int64_t sim_time_ns() const noexcept { return tick_ * rig_.loop.tick_ns(); }

  /// Everything but header and mac.
  void fill(state_t& state) const noexcept;
  void fill(truth_t& truth) const noexcept;
  /// Only what the integrator knows: service, mode, text, speed, commands and requests.
  void fill(status_t& status) const noexcept;

  static constexpr int kHistory = 64;
  /// The last ticks, oldest first; fewer at the start of a run.
  template <class Visit>
  void visit_history(Visit visit) const {
    const std::int64_t count = std::min<std::int64_t>(tick_, kHistory);
    for (std::int64_t k = tick_ - count; k < tick_; ++k) visit(history_[k % kHistory]);
  }

 private:
  void enter(Event event, std::string_view why) noexcept;
  bool reset(const request_t& request, std::int64_t fresh_epoch, reply_t& reply) noexcept;
  bool disturb(const request_t& request, reply_t& reply) noexcept;
  bool act(const request_t& request, const Surroundings& surroundings, reply_t& reply) noexcept;
  model::Input commanded() noexcept;
  model::Input safe_stop() const noexcept;

  const Rig& rig_;
  model::Machine machine_;
  std::int32_t valid_;
  Plant plant_;
  CommandGate gate_;
  Disturbances disturbances_;
  model::Input input_;  // of the last tick
  model::Truth truth_;  // at the present tick, with that input

  Mode mode_ = Mode::kHeld;
  std::int64_t epoch_;
  std::int64_t tick_ = 0;
  double speed_ = 1.0;
  std::int64_t steps_left_ = 0;  // of a step request
  bool waiting_for_controller_ = false;
  bool lying_ = false;                                  // fallen flat: nothing moves any more
  std::array<double, model::kMaxDrives> held_speed_{};  // of the drives when the safe stop began
  std::int64_t evaluations_max_ = 0;
  Askers askers_;
  reply_t last_reply_{};
  std::array<std::uint8_t, 96> why_{};
  std::array<TickRecord, kHistory> history_{};
};

}  // namespace gyrotwin
