// All of the live system that is no physics, once a tick: sensors and estimator, law, the way of
// commands, scheduled events, safe stop.
#pragma once

#include <cstdint>
#include <optional>

#include "clients/simulate/simulation.hpp"
#include "services/controller/law.hpp"
#include "services/integrator/schedule.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/onboard/estimator.hpp"
#include "services/onboard/safe_stop.hpp"
#include "services/runtime/command_gate.hpp"

namespace gyrotwin {

/// What owner and controller do in lockstep, in their order and with their parts.
class SampledLoop {
 public:
  /// All outlive it.
  /// @throws Error when the law does not fit, or the rig cannot have one of the scenario's events
  SampledLoop(const Rig& rig, const model::Machine& machine, const Scenario& scenario);

  /// What acts over tick k, which begins at t [s] in this state. Once a tick, in order.
  const model::Input& over_tick(std::int64_t k, double t, const model::State& state) noexcept;
  /// Tick k has led to this state, with that input: the sensors look at it.
  void look(std::int64_t k, const model::State& state, const model::Input& input) noexcept;

  /// What STATE says where it is an estimate, null where it is the truth.
  const model::Observation* estimate() const noexcept {
    return estimator_ ? &estimator_->seen() : nullptr;
  }
  /// The tick since which no commands act, for want of valid ones.
  std::optional<std::int64_t> stopped_at() const noexcept { return stopped_at_; }

 private:
  void schedule(const Scenario& scenario);
  void measure(std::int64_t tick, const model::State& state, const model::Input& input) noexcept;
  std::optional<model::Observation> heard(const model::State& state) const noexcept;
  std::optional<DriveTorques> torques(double t, const model::State& state) noexcept;
  void command(std::int64_t k, const DriveTorques& torques) noexcept;

  const Rig& rig_;
  const model::Machine& machine_;
  const Scenario& scenario_;
  std::int32_t needed_;  // groups of STATE, without which a controller says nothing
  Schedule schedule_;
  std::optional<SimulatedSensors> sensing_;
  sensors_t sensors_{};
  std::optional<OnboardEstimator> estimator_;
  std::optional<SampledLaw> law_;  // none where the scenario has torques
  bool law_started_ = false;
  CommandGate gate_;
  SafeStop safe_stop_;
  std::optional<std::int64_t> stopped_at_;
  model::Input input_;
};

}  // namespace gyrotwin
