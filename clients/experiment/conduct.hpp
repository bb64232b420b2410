// Experiments on whoever owns a rig, over the bus.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/calibrate/experiments.hpp"
#include "clients/common/asker.hpp"

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

/// Why this rig, as its file has it, is not fit for the experiment, and what to do; empty: it is.
/// @param simulated the owner's plant is; else what is done by hand is left to the operator
/// @param given the `key=value` overrides that the rig was loaded with
std::string misfit(const ExperimentPlan& plan, const Rig& rig, bool simulated,
                   const std::vector<std::string>& given = {});

/// What is to be done by hand beforehand; empty: nothing.
std::string by_hand(const ExperimentPlan& plan, bool simulated);

/// Where a simulated rig starts. @return empty: where the rig file says
std::optional<request_t> start_of(const ExperimentPlan& plan);

/// Does it, from HELD to SAFE_STOP. However it ends, the drives are off.
/// @param go_on asked at least ten times a second
/// @throws NotDone when the owner refuses, falls silent, or `go_on` says no
void conduct(const ExperimentPlan& plan, const Rig& rig, Asker& asker,
             const std::function<bool()>& go_on);

}  // namespace gyrotwin
