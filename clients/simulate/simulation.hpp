// A rig's plant and law, run offline from a start to an end. Pure: inputs in, samples out; the same
// bits as the live system where feedback is sampled and steps are fixed.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/simulate/verdict.hpp"
#include "messages/channels.hpp"
#include "services/controller/law.hpp"
#include "services/integrator/stepper.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// When and in which state an input is asked for.
struct Instant {
  double t;       ///< [s]
  double within;  ///< inside the piece of time that is being integrated: what jumps at breakpoints
                  ///< is read here, and so never from the wrong side [s]
  const model::State& state;
};

/// What acts on the structure, world frame, the force at the push point.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< [N m]
};

/// A function of time and state, smooth between its breakpoints; absent: zero. Both must be
/// finite: what is not ends the simulation.
template <class Value>
struct InputFunction {
  std::function<Value(const Instant&)> value;
  std::vector<double> breakpoints;  ///< where it jumps, ascending [s]
};

/// What to simulate.
struct Scenario {
  model::State start;
  double duration = 10.0;  ///< [s], whole ticks where time goes in ticks
  std::optional<double>
      sample;           ///< between samples [s]; by default 0.01 s, or the ticks next to it
  bool sampled = true;  ///< drives held over each tick, as in the live system
  StepPolicy stepping;  ///< substeps are of a tick
  std::optional<InputFunction<DriveTorques>> torque;  ///< replaces the rig's law [N m]
  InputFunction<Wrench> external;

  /// A DISTURB or FAULT, asked for while the platform is held.
  struct Event {
    request_t request;
    std::string place;  ///< for messages
  };
  std::vector<Event> events;  ///< in the order of asking; sampled feedback only
};

/// The machine at one instant.
struct Sample {
  double t;  ///< [s]
  const model::State& state;
  const model::Input& input;           ///< that led here; at the start of sampled feedback: none
  const model::Observation* estimate;  ///< what STATE says; null where it says the truth
};

/// How far a simulation came, and how it ended.
struct Outcome {
  enum class End {
    kDuration,        ///< reached
    kStopped,         ///< by the spectator
    kInputNotFinite,  ///< a torque or wrench was not finite
    kNotFinite        ///< the solver failed or the state was not finite
  };
  End end = End::kDuration;              ///< while it goes on: not yet
  double t = 0.0;                        ///< last time with a sound state [s]
  Verdict verdict{};                     ///< of all until then
  std::optional<double> safe_stop_at{};  ///< when commands were lost, for good [s]
};

/// Who looks on. Called in order of time.
class Spectator {
 public:
  virtual ~Spectator() = default;
  /// Every sample, start and end included.
  virtual void sample(const Sample& sample) = 0;
  /// Between samples too, at least every 10 ms of simulated time. @return whether to go on
  virtual bool go_on(const Outcome& until_now) = 0;
};

/// Runs a scenario. Sampled feedback goes as a live system in lockstep: the law once a tick on what
/// STATE says, its torque held from `command_delay_ticks` later, and with fixed steps the very same
/// bits. Quick steps are for sampled feedback. Continuous feedback asks law or torque at every
/// evaluation and integrates the law's memory too; it knows neither events nor estimates.
/// @param rig its law, unless the scenario has a torque; its tick, delay and fall limit
/// @param machine the rig's, whose drives may have been changed
/// @throws Error when law, tick, sample, duration and events do not fit together
Outcome simulate(const Rig& rig, const model::Machine& machine, const Scenario& scenario,
                 Spectator& spectator);

/// The machine with drives that give any torque at any speed.
model::Machine with_ideal_drives(model::Machine machine);

}  // namespace gyrotwin
