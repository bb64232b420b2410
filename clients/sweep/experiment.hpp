// One run of a sweep: a rig with other numbers, from its start to its end.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/common/scenario.hpp"
#include "clients/simulate/trial.hpp"
#include "clients/sweep/plan.hpp"

namespace gyrotwin {

/// What all runs have in common.
struct Bench {
  std::string rig;                     ///< name or path
  std::vector<std::string> overrides;  ///< as in --set
  ScenarioFile scenario = {};          ///< an empty document: nothing happens
  double duration = 20.0;              ///< [s]
  StepPolicy::Kind stepper = StepPolicy::Kind::kQuick;
};

/// A line of the result for every run of a plan. The same line whoever asks, and when.
class Experiment {
 public:
  /// @throws Error when a factor has nothing to multiply, or none of the first runs can be made, as
  ///         it is with a misspelt key
  Experiment(Bench bench, Plan plan);

  const Plan& plan() const { return plan_; }
  /// Of the CSV: run, the variables' keys, verdict, fell_at_s, largest_tilt_rad, ...
  std::string header() const;
  /// A CSV line with its newline. A rig that cannot be is `impossible`, the rest of it empty.
  std::string line(std::int64_t run) const;

  /// Why there is no such rig; empty: there is.
  std::string refusal(std::int64_t run) const;

  /// What a shell is to be told to `gyrotwin simulate` this run; events keep their numbers in the
  /// scenario.
  std::string repeat_command(std::int64_t run) const;

 private:
  /// A run's numbers, sorted by where they go.
  struct Settings {
    std::vector<std::string> rig, start, events;  // key=value
  };
  /// What settings of the rig make of it.
  struct Built {
    std::vector<std::string> settings;
    Rig rig;
    model::Machine machine;
  };
  void check() const;
  /// Factors multiplied.
  Point values(std::int64_t run) const;
  Settings settings(const Point& values) const;
  std::vector<Scenario::Event> events_of(const Rig& rig,
                                         const std::vector<std::string>& settings) const;
  /// @throws Error when there is no such rig
  const Built& built(const std::vector<std::string>& settings) const;
  Trial trial(const Settings& settings) const;
  double duration_of(const Settings& settings) const;  // in whole ticks [s]

  Bench bench_;
  Plan plan_;
  std::map<std::string, double> base_;  // of keys that are multiplied
  // Of the last run: the next one's, where it only starts elsewhere.
  mutable std::optional<Built> built_;
};

}  // namespace gyrotwin
