// All that can be said of whether a rig stands, and why.
#pragma once

#include <string>
#include <vector>

#include "clients/analyze/cases.hpp"
#include "clients/analyze/conditions.hpp"
#include "clients/analyze/limits.hpp"
#include "clients/analyze/solutions.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

struct Analysis {
  std::vector<Case> cases;  ///< the first is the rig as its file has it
  std::string reason;       ///< why that one stands or falls
  std::string caution;      ///< what to know before building it; empty: nothing
  Theory theory;
  std::vector<Comparison> comparisons;  ///< closed forms against integration
  std::vector<Limit> limits;
  double duration;   ///< of undisturbed runs, at least [s]
  double fall_tilt;  ///< of the rig [rad]

  const Case& as_filed() const { return cases.front(); }
};

/// @param duration of undisturbed runs [s]; pushes and limits are looked at over a third of it
/// @throws Error where the rig's law does not fit its machine
Analysis analyse(const Rig& rig, double duration, int threads);

}  // namespace gyrotwin
