#include "clients/simulate/trial.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gyrotwin {

namespace {

constexpr double kRounding = 1e-12;

double slowest_rotor(const model::Machine& machine, const model::State& state) {
  double least = 1.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(machine.rotors); ++i) {
    const double nominal = machine.nominal_rotor_speed[i];
    if (nominal != 0.0) least = std::min(least, state.rotor_speed[i] / nominal);
  }
  return least;
}

/// Looks on every tick, and goes home when it has fallen.
class Watcher : public Spectator {
 public:
  Watcher(const model::Machine& machine, const Scenario& scenario) : machine_(machine) {
    trial.first_rotor_share = slowest_rotor(machine, scenario.start);
    trial.least_gimbal_margin = std::numeric_limits<double>::infinity();
  }

  void sample(const Sample& sample) override {
    const model::Effort effort = machine_.effort(sample.state, sample.input);
    trial.least_gimbal_margin =
        std::min(trial.least_gimbal_margin, machine_.gimbal_margin(sample.state));
    for (const double torque : effort.drive_torque) {
      trial.largest_torque = std::max(trial.largest_torque, std::abs(torque));
    }
    ++ticks_;
    if (at_limit(effort)) ++ticks_at_limit_;
    trial.at_limit = static_cast<double>(ticks_at_limit_) / static_cast<double>(ticks_);
    const auto [x, y] = effort.holding_moment;
    trial.largest_holding_moment = std::max(trial.largest_holding_moment, std::hypot(x, y));
  }
  bool go_on(const Outcome& until_now) override { return !until_now.verdict.fell_at(); }

  Trial trial;

 private:
  bool at_limit(const model::Effort& effort) const {
    for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
      const double torque = std::abs(effort.drive_torque[i]);
      if (torque > 0.0 && effort.drive_margin[i] <= kRounding * torque) return true;
    }
    return false;
  }

  const model::Machine& machine_;
  std::int64_t ticks_ = 0, ticks_at_limit_ = 0;
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
  Watcher watcher(machine, scenario);
  Trial& trial = watcher.trial;
  trial.outcome = simulate(rig, machine, scenario, watcher);
  trial.end_tilt = trial.outcome.verdict.tilt();
  trial.largest_tilt = trial.outcome.verdict.largest_tilt();
  return trial;
}

}  // namespace gyrotwin
