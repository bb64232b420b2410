// The gain of a linear law: taken from the rig file, or solved from the weights there.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// u = -K x on the linear model x' = F x + B u.
struct Feedback {
  Eigen::RowVectorXd K;
  Eigen::VectorXcd poles;  ///< of F - B K [1/s], sorted as by poles()

  /// "K = (...), closed-loop poles ... 1/s".
  std::string describe() const;
};

/// Poles as people write them: "-5.4+-6.3i, -1.2 1/s".
std::string listed(const Eigen::VectorXcd& poles);

/// Bryson's weight: Q(state, state) = 1 / largest^2.
struct Weight {
  int state;
  std::optional<double> largest;  ///< acceptable deviation, in the state's unit
};

/// `[controller] gain` when the rig gives it, otherwise the regulator for the weights and
/// R = 1 / torque_max^2.
/// @pre without a gain, the weights are there
/// @throws Error when the gain has not one number a state, or no gain stabilises
Feedback feedback_for(const Rig& rig, const Eigen::MatrixXd& F, const Eigen::VectorXd& B,
                      const std::vector<Weight>& weights);

}  // namespace gyrotwin
