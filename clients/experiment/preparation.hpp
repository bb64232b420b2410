// What an experiment asks of a rig beforehand.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clients/calibrate/experiments.hpp"

namespace gyrotwin {

/// What is asked for.
struct ExperimentPlan {
  const ExperimentKind* kind;
  double driven_s = 5.0;       ///< coast-down: how long the law drives the disc [s]
  double watched_s = 10.0;     ///< then, or altogether [s]; watched_s() says how long is enough
  double tilt_rad = 0.1;       ///< swing: where a simulated rig starts
  double mass_kg = 0.0;        ///< swing: the counterweight
  double mass_height_m = 0.0;  ///< < 0: below the pivot
};

bool is_named(const ExperimentPlan& plan, std::string_view name);

/// Why this rig, as its file has it, is not fit for the experiment, and what to do; empty: it is.
/// @param simulated the owner's plant is; else what is done by hand is left to the operator
/// @param given the `key=value` overrides that the rig was loaded with
std::string misfit(const ExperimentPlan& plan, const Rig& rig, bool simulated,
                   const std::vector<std::string>& given = {});

/// What is to be done by hand beforehand; empty: nothing.
std::string by_hand(const ExperimentPlan& plan, bool simulated);

}  // namespace gyrotwin
