#include "clients/analyze/recording.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

constexpr int kSamples = 2000;

/// Some quantities of a run, sampled until its end or until it has lain down.
class Recording : public Spectator {
 public:
  Recording(const model::Machine& machine, double fall_tilt, Look look)
      : machine_(machine), gone_(std::min(1.3 * fall_tilt, 1.4)), look_(std::move(look)) {}
  void sample(const Sample& sample) override {
    const std::vector<double> seen = look_(sample);
    columns.resize(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) columns[i].push_back(seen[i]);
    lies_ = lies_ || machine_.tilt(sample.state) > gone_;
  }
  bool go_on(const Outcome&) override { return !lies_; }
  Columns columns;

 private:
  const model::Machine& machine_;
  double gone_;
  Look look_;
  bool lies_ = false;
};

}  // namespace

Columns record(const Rig& rig, const model::Machine& machine, Scenario scenario, const Look& look,
               bool every_tick) {
  const double tick = rig.loop.tick_s();
  const double wanted = scenario.duration / kSamples;
  const double sample = every_tick ? tick : std::max(1.0, std::round(wanted / tick)) * tick;
  scenario.duration = std::max(1.0, std::round(scenario.duration / sample)) * sample;
  scenario.sample = sample;
  Recording recording(machine, rig.safety.fall_tilt_rad, look);
  simulate(rig, machine, scenario, recording);
  return recording.columns;
}

}  // namespace gyrotwin
