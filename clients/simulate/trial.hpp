// One run of a rig as it would run live, but for how it is stepped, and what became of it.
#pragma once

#include <optional>
#include <string>

#include "clients/simulate/simulation.hpp"

namespace gyrotwin {

/// What was seen of a run at its samples, until its end or its fall.
struct Trial {
  Outcome outcome;
  double end_tilt = 0.0;                ///< 0 without a tilt [rad]
  double largest_tilt = 0.0;            ///< likewise [rad]
  double least_gimbal_margin = 0.0;     ///< to a stop, < 0 in it [rad]
  double largest_torque = 0.0;          ///< of any drive, what arrives of it, as a magnitude [N m]
  double at_limit = 0.0;                ///< share of the ticks with a drive at its limit [1]
  double first_rotor_share = 1.0;       ///< slowest rotor at the start, of its nominal speed [1]
  double largest_holding_moment = 0.0;  ///< by the external support of mount `level` [N m]

  /// Neither fell nor met an error: it came to the end of its time.
  bool stood() const;
};

/// The rig under its own law and feedback from its initial state, as the live system would run it,
/// with fixed steps and a sample every tick.
/// @param duration [s]; rounded to whole ticks
Scenario live_scenario(const Rig& rig, const model::Machine& machine, double duration);

/// Runs a scenario, at most until it falls. Two trials of the same scenario are the same to the
/// last bit.
/// @throws Error as simulate()
Trial run_trial(const Rig& rig, const model::Machine& machine, const Scenario& scenario);

}  // namespace gyrotwin
