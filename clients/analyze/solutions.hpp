// The reduced models' closed-form motions, beside what integration makes of them. Derivation:
// services/model/README.md, sections 4 and 5.
#pragma once

#include <string>
#include <vector>

#include "services/model/gimballed.hpp"
#include "services/model/umbrella.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// One motion, or one number of it, by formula and by integration.
struct Comparison {
  std::string key;
  std::string meaning;  ///< "released at 1 deg: tilt over 3 periods, reduced model integrated"
  double formula;       ///< a number of the motion, or its largest tilt
  double integrated;    ///< the same
  double deviation;     ///< the largest over the motion, as a share of its size [1]
  std::string unit;
};

/// Tilt [rad], tilt rate [rad/s], disc rate [rad/s] of the reduced umbrella platform on one branch.
struct ReducedState {
  double tilt, tilt_rate, disc_rate;
};

/// Undriven, frictionless motion at time t [s].
ReducedState free_motion(const model::ReducedUmbrella& reduced, const ReducedState& start,
                         double t);
/// The same with a disc torque F sin(w t) [N m].
/// @pre w > 0 and not the natural frequency
ReducedState driven_motion(const model::ReducedUmbrella& reduced, const ReducedState& start,
                           double F, double w, double t);

/// What can be compared for this rig.
std::vector<Comparison> compare_solutions(const Rig& rig);

}  // namespace gyrotwin
