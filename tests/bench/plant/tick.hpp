// One tick of a rig beside MuJoCo's steps: time, and what the steps are off by.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/plant/scenario.hpp"

namespace gyrotwin::bench {

/// A machine that somebody steps from tick to tick of its rig.
class Ticker {
 public:
  virtual ~Ticker() = default;
  virtual std::string name() const = 0;
  virtual void start(const model::State& state) = 0;
  /// With the input held. @throws Error when the solver fails
  virtual void tick(const model::Input& input) = 0;
  /// In the ticker's own coordinates [rad].
  virtual model::Coordinates coordinates() const = 0;
};

/// The rig's plant, in the rig's own steps or in so many a millisecond.
std::unique_ptr<Ticker> gyrotwin_ticker(const Rig& rig, std::optional<int> steps_per_ms = {});
/// The same solved to 1e-12.
std::unique_ptr<Ticker> gyrotwin_reference(const Rig& rig);
/// mj_step() with its Runge-Kutta 4, so many steps in a millisecond.
std::unique_ptr<Ticker> mujoco_ticker(const Rig& rig, int steps_per_ms);
/// The same method with the gears projected.
std::unique_ptr<Ticker> mujoco_projected_ticker(const Rig& rig, int steps_per_ms);

/// The rigs whose ticks are measured.
const std::vector<std::string>& tick_rigs();

/// Prints what everybody's steps are off by at most, each against its own reference, then times
/// single ticks, in turns, for so long [s]; prints p50, p99, max.
void measure_ticks(const std::string& rig, double seconds);

}  // namespace gyrotwin::bench
