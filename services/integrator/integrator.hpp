// The owner of a simulated plant: physics, disturbances and sensors, tick by tick. Pure: it sees
// neither bus nor clock; services/integrator/service.hpp wires it to both.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "messages/channels.hpp"
#include "services/integrator/plant.hpp"
#include "services/integrator/schedule.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/onboard/estimator.hpp"
#include "services/onboard/safe_stop.hpp"
#include "services/runtime/owner.hpp"

namespace gyrotwin {

/// What acted in a tick and where it led; the last ones are logged on a fault.
struct TickRecord {
  std::int64_t tick;
  model::State state;  ///< before the tick
  model::Input input;
};

class Integrator final : public Owner {
 public:
  /// HELD at the rig's initial state.
  /// @param rig outlives the integrator
  /// @param epoch random, of the first run
  Integrator(const Rig& rig, std::int64_t epoch);

  bool on_command(const command_t& command) noexcept override;

  /// Runs one tick if time goes on in this mode.
  void advance() noexcept;
  /// HELD, after ROTORS: the rotors run for so long [s], and nothing else moves.
  /// @return whether STATE 0 is another one now
  bool hold(double seconds) noexcept;

  double speed() const noexcept { return speed_; }
  /// The command for the present tick has come, be it that a fault has kept it from acting
  /// (lockstep).
  bool answered() const noexcept { return gate_.answered(tick_) || unobeyed_tick_ == tick_; }
  /// The next advance() would be a safe stop for want of commands (realtime, or by a fault).
  bool command_lost() const noexcept {
    const bool counts = rig_.loop.clock == ClockMode::kRealtime ||
                        (rig_.loop.clock == ClockMode::kLockstep && command_link_cut());
    return mode() == Mode::kRunning && counts && timed_out();
  }
  /// By a fault.
  bool command_link_cut() const noexcept { return schedule_.command_lost(tick_); }
  /// Stands still until the controller answers (lockstep).
  bool waiting_for_controller() const noexcept { return waiting_for_controller_; }
  const GroundedPlant& plant() const noexcept { return plant_; }

  /// Everything but header and mac.
  void fill(state_t& state) const noexcept;
  void fill(truth_t& truth) const noexcept;
  bool has_sensors() const noexcept { return sensing_.has_value(); }
  void fill(sensors_t& sensors) const noexcept { sensors = sensors_; }
  /// Everything but the wiring's: process, bus and loop.
  void fill(status_t& status) const noexcept;

  static constexpr int kHistory = 64;
  /// The last ticks, oldest first; fewer at the start of a run.
  template <class Visit>
  void visit_history(Visit visit) const {
    const std::int64_t first = std::max<std::int64_t>(0, recorded_ - kHistory);
    for (std::int64_t k = first; k < recorded_; ++k) visit(history_[k % kHistory]);
  }

 private:
  void entering(Event event, Mode to) noexcept override;
  bool reset(const request_t& request, std::int64_t fresh_epoch, reply_t& reply) noexcept;
  bool schedule(const request_t& request, reply_t& reply) noexcept;
  bool set_rotors(const request_t& request, reply_t& reply) noexcept;
  bool set_speed(const request_t& request, reply_t& reply) noexcept;
  bool step(const request_t& request, const Surroundings& surroundings, reply_t& reply) noexcept;
  bool act(const request_t& request, const Surroundings& surroundings,
           reply_t& reply) noexcept override;
  model::Input commanded() noexcept;

  void stand(const model::State& state) noexcept;
  void look() noexcept;
  bool rotors_powered() const noexcept { return rotors_asked_.value_or(true); }
  double rotor_share() const noexcept;
  double rotor_time(bool powered) const noexcept;

  model::Machine machine_;
  std::int32_t valid_;
  GroundedPlant plant_;
  Schedule schedule_;
  SafeStop safe_stop_;
  model::Input input_;                         // of the last tick
  model::Truth truth_;                         // at the present tick, with that input
  std::optional<SimulatedSensors> sensing_;    // a rig with [sensors]
  sensors_t sensors_{};                        // at the present tick
  std::optional<OnboardEstimator> estimator_;  // loop.state = "estimate"
  std::optional<bool> rotors_asked_;           // by ROTORS in this run: up or down

  std::int64_t unobeyed_tick_ = -1;  // its command came while a fault kept commands from acting
  double speed_ = 1.0;
  std::int64_t steps_left_ = 0;  // of a step request
  bool waiting_for_controller_ = false;
  std::int64_t evaluations_max_ = 0;
  std::array<TickRecord, kHistory> history_{};
  std::int64_t recorded_ = 0;  // ticks of this run in history_, the one that failed included
};

}  // namespace gyrotwin
