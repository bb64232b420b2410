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

/// Small deviations from a steady motion: x' = F x. The states are the coordinates without the
/// cyclic one, all rates, and what the law remembers.
struct Modes {
  std::vector<std::string> states;
  Eigen::MatrixXd F;
  /// Of F; with a law of the loop as it is sampled, ln(mu) / tick for every eigenvalue mu of one
  /// tick, without those of the command's way. The fastest-growing first [1/s].
  Eigen::VectorXcd eigenvalues;
  double growth = 0.0;      ///< the largest real part [1/s]
  double difference = 0.0;  ///< of F's accelerations against central differences, relative [1]
  bool kink = false;        ///< the law bends there (it takes the tilt's magnitude); F has the mean
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
};
std::optional<LinearModel> linear_model(const Rig& rig);

}  // namespace gyrotwin
