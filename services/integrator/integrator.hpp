// The owner of a simulated plant: modes, commands, requests and physics, tick by tick. Pure: it
// sees neither bus nor clock; services/integrator/service.hpp wires it to both.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "messages/channels.hpp"
#include "services/integrator/plant.hpp"
#include "services/integrator/safe_stop.hpp"
#include "services/integrator/schedule.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/onboard/estimator.hpp"
#include "services/runtime/command_gate.hpp"
#include "services/runtime/mode.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/text.hpp"

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

/// The last answer to each of those who have asked. The longest silent one is forgotten first.
class Askers {
 public:
  /// The last answer to this writer, null when it has not asked before.
  const reply_t* last(std::int64_t writer) const noexcept {
    const auto asker = find(writer);
    return asker == answers_.end() ? nullptr : &*asker;
  }

  void remember(const reply_t& answer) noexcept {
    auto place = answers_.begin() + (find(answer.request_writer) - answers_.begin());
    if (place == answers_.end()) --place;
    std::move_backward(answers_.begin(), place, place + 1);
    answers_.front() = answer;
  }

 private:
  std::array<reply_t, 64>::const_iterator find(std::int64_t writer) const noexcept {
    return std::find_if(answers_.begin(), answers_.end(), [writer](const reply_t& answer) {
      return answer.result != 0 && answer.request_writer == writer;
    });
  }

  std::array<reply_t, 64> answers_{};
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
  /// answered already (same writer and counter) gets the same answer and is not done again; one
  /// that was recorded on the network and comes again later (a lower counter) is refused.
  void on_request(const request_t& request, const Surroundings& surroundings,
                  reply_t& reply) noexcept;
  /// Something noticed on the bus or in the loop; `why` is shown in STATUS.
  void notice(Event event, std::string_view why) noexcept;

  /// Runs one tick if time goes on in this mode.
  void advance() noexcept;
  /// HELD, after ROTORS: the rotors run for so long [s], and nothing else moves.
  /// @return whether STATE 0 is another one now
  bool hold(double seconds) noexcept;

  Mode mode() const noexcept { return mode_; }
  /// Why it is in this mode; empty where that needs no word.
  std::string_view why() const noexcept { return text_view(why_); }
  std::int64_t tick() const noexcept { return tick_; }
  std::int64_t epoch() const noexcept { return epoch_; }
  double speed() const noexcept { return speed_; }
  /// The command for the present tick has come, be it that a fault has kept it from acting
  /// (lockstep).
  bool answered() const noexcept { return gate_.answered(tick_) || unobeyed_tick_ == tick_; }
  /// The next advance() would be a safe stop for want of commands (realtime, or by a fault).
  bool command_lost() const noexcept {
    const bool counts = rig_.loop.clock == ClockMode::kRealtime ||
                        (rig_.loop.clock == ClockMode::kLockstep && command_link_cut());
    return mode_ == Mode::kRunning && counts && gate_.lost(tick_);
  }
  /// By a fault.
  bool command_link_cut() const noexcept { return schedule_.command_lost(tick_); }
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
  bool has_sensors() const noexcept { return sensing_.has_value(); }
  void fill(sensors_t& sensors) const noexcept { sensors = sensors_; }
  /// Only what the integrator knows: service, mode, text, speed, commands and requests.
  void fill(status_t& status) const noexcept;

  static constexpr int kHistory = 64;
  /// The last ticks, oldest first; fewer at the start of a run.
  template <class Visit>
  void visit_history(Visit visit) const {
    const std::int64_t first = std::max<std::int64_t>(0, recorded_ - kHistory);
    for (std::int64_t k = first; k < recorded_; ++k) visit(history_[k % kHistory]);
  }

 private:
  void enter(Event event, std::string_view why) noexcept;
  bool reset(const request_t& request, std::int64_t fresh_epoch, reply_t& reply) noexcept;
  bool schedule(const request_t& request, reply_t& reply) noexcept;
  bool set_rotors(const request_t& request, reply_t& reply) noexcept;
  bool set_speed(const request_t& request, reply_t& reply) noexcept;
  bool change_mode(const request_t& request, Event event, const Surroundings& surroundings,
                   reply_t& reply) noexcept;
  bool act(const request_t& request, const Surroundings& surroundings, reply_t& reply) noexcept;
  model::Input commanded() noexcept;
  std::array<double, model::kMaxDrives> estimated_torque() const noexcept;

  void stand(const model::State& state) noexcept;
  void look() noexcept;
  void run_rotors(const model::Input& input, double seconds) noexcept;
  bool rotors_powered() const noexcept { return rotors_asked_.value_or(true); }
  double rotor_share() const noexcept;
  double rotor_time(bool powered) const noexcept;

  const Rig& rig_;
  model::Machine machine_;
  std::int32_t valid_;
  Plant plant_;
  CommandGate gate_;
  Schedule schedule_;
  SafeStop safe_stop_;
  model::Input input_;                         // of the last tick
  model::Truth truth_;                         // at the present tick, with that input
  std::optional<SimulatedSensors> sensing_;    // a rig with [sensors]
  sensors_t sensors_{};                        // at the present tick
  std::optional<OnboardEstimator> estimator_;  // loop.state = "estimate"
  std::optional<bool> rotors_asked_;           // by ROTORS in this run: up or down

  Mode mode_ = Mode::kHeld;
  std::int64_t epoch_;
  std::int64_t tick_ = 0;
  std::int64_t unobeyed_tick_ = -1;  // its command came while a fault kept commands from acting
  double speed_ = 1.0;
  std::int64_t steps_left_ = 0;  // of a step request
  bool waiting_for_controller_ = false;
  bool lying_ = false;  // fallen flat: nothing moves any more
  std::int64_t evaluations_max_ = 0;
  Askers askers_;
  std::int64_t request_writer_ = 0, request_counter_ = 0;  // the last one that was applied
  std::uint8_t why_[96] = {};
  std::array<TickRecord, kHistory> history_{};
  std::int64_t recorded_ = 0;  // ticks of this run in history_, the one that failed included
};

}  // namespace gyrotwin
