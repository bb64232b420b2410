// How a rig behaves close to its steady motion.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "clients/analyze/steady_motion.hpp"
#include "services/controller/law.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// A growth below it doubles in two hours and counts for none [1/s].
inline constexpr double kNoGrowth = 1e-4;

/// Small deviations from a steady motion: x' = F x. The states are the coordinates without the
/// cyclic one, all rates, and what the law remembers.
struct Modes {
  std::vector<std::string> states;
  Eigen::MatrixXd F;
  /// Of F; with a law of the loop as it is sampled, ln(mu) / tick for the eigenvalues mu of one
  /// tick. Commands on their way make more of these than there are states: the smallest, which are
  /// forgotten first, are left out. The fastest-growing first [1/s].
  Eigen::VectorXcd eigenvalues;
  double growth = 0.0;       ///< the largest real part [1/s]
  double difference = 0.0;   ///< of F's accelerations against central differences, relative [1]
  bool law_bends = false;    ///< there (it takes the tilt's magnitude); F has the mean slope
  bool plant_bends = false;  ///< there (an axle just touches, a stop); F has the slope of one side

  /// The derivatives are those of both sides, and differences agree: growth tells what happens.
  bool sound() const;
};

/// @param law null: the drives give nothing
/// @pre steady.found
Modes modes_about(const Rig& rig, const model::Machine& machine, const Law* law,
                  const SteadyMotion& steady);

/// Steady motion and modes of a rig under its own law, where there are any: what a map or a locus
/// asks of many rigs. Empty when the law is a function of time or nothing is steady.
struct LinearModel {
  SteadyMotion steady;
  Modes modes;
  bool estimated = false;  ///< the law sees an estimate, which is not in the modes

  /// Of small deviations, where the modes are all there is to know [1/s].
  std::optional<double> growth() const;
};
std::optional<LinearModel> linear_model(const Rig& rig);

}  // namespace gyrotwin
