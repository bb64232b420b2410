#include "clients/simulate/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gyrotwin {

namespace {

/// Looks on every tick, and goes home when it has fallen.
class Watcher : public Spectator {
 public:
  Watcher(const Rig& rig, const model::Machine& machine, double duration)
      : machine_(machine), verdict_(rig, machine, duration) {
    trial.least_gimbal_margin = std::numeric_limits<double>::infinity();
  }

  void sample(const Sample& sample) override {
    verdict_.note(sample.t, machine_, sample.state);
    const model::Truth truth = machine_.truth(sample.state, sample.input);
    trial.least_gimbal_margin = std::min(trial.least_gimbal_margin, truth.gimbal_margin);
    for (const double torque : truth.drive_torque) {
      trial.largest_torque = std::max(trial.largest_torque, std::abs(torque));
    }
    const auto [x, y] = truth.holding_moment;
    trial.largest_holding_moment = std::max(trial.largest_holding_moment, std::hypot(x, y));
  }
  bool go_on(double /*t*/) override { return !verdict_.fell_at(); }

  Trial trial;

 private:
  const model::Machine& machine_;
  Verdict verdict_;
};

}  // namespace

bool Trial::stood() const {
  return outcome.end == Outcome::End::kDuration && !outcome.verdict.fell_at();
}

Scenario live_scenario(const Rig& rig, const model::Machine& machine, double duration) {
  Scenario scenario;
  scenario.start = rig.initial_state(machine);
  const double tick = rig.loop.tick_s();
  scenario.duration = std::max(1.0, std::round(duration / tick)) * tick;
  scenario.sample = tick;
  scenario.stepping.substeps = rig.loop.substeps;
  return scenario;
}

Trial run_trial(const Rig& rig, const model::Machine& machine, const Scenario& scenario) {
  Watcher watcher(rig, machine, scenario.duration);
  Outcome outcome = simulate(rig, machine, scenario, watcher);
  Trial trial = watcher.trial;
  trial.end_tilt = outcome.verdict.tilt();
  trial.largest_tilt = outcome.verdict.largest_tilt();
  trial.outcome = std::move(outcome);
  return trial;
}

}  // namespace gyrotwin
