// What a fit has found of each parameter, and what it may not claim.
#pragma once

#include <string>
#include <vector>

#include "clients/calibrate/experiments.hpp"
#include "clients/calibrate/fit.hpp"

namespace gyrotwin::calibration {

/// One parameter's end.
struct Finding {
  std::string key;
  double start, value;  ///< in the rig file; found
  double sigma;         ///< of `value`, standard deviation
  double alone;         ///< relative standard deviation if all others were known
  std::string refusal;  ///< why it is not identified; empty: it is
  std::string advice;   ///< the experiment that would tell it; empty: none is known, or no need

  bool identified() const { return refusal.empty(); }
  double relative() const { return sigma / std::abs(value); }
};

/// Relative standard deviation above which a parameter is refused.
inline constexpr double kRefused = 0.3;

/// @param known of the fit, deviations inflated where the fit asks for it
std::vector<Finding> findings(const Family& family, const Fit& fit, const Identifiability& known);

}  // namespace gyrotwin::calibration
