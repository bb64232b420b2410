// What data can tell of parameters, and what they cannot: from the derivatives of all residuals,
// by orthogonal transformations alone.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "clients/calibrate/segment.hpp"

namespace gyrotwin::calibration {

/// Collects the derivatives of the segments of one fit and eliminates every state as it goes.
class InformationFilter {
 public:
  InformationFilter(Eigen::Index parameters, const std::vector<Bias>& biases);

  /// The next segment, in order. @param shot with derivatives
  void add(const Segment& segment, const Shot& shot, int coordinates);

  /// Upper triangular R: R'R is the information on the parameters in multiples of their scales,
  /// whatever states and biases are.
  Eigen::MatrixXd root() const;

 private:
  Eigen::Index parameters_, biases_;
  Eigen::MatrixXd carried_;  // on (state | biases, parameters) from the segments before
  Eigen::MatrixXd known_;    // on (biases, parameters)
};

/// What is known of one parameter.
struct Knowledge {
  double sigma = 0.0;  ///< relative, standard deviation; infinite where there is no information
  double alone = 0.0;  ///< the same if all other parameters were known
  /// Parameters that it cannot be told from: those of the weakest direction that it is part of.
  std::vector<std::size_t> entangled = {};
};

struct Identifiability {
  Eigen::VectorXd singular;     ///< of R, falling: 1 / sigma along the columns of `directions`
  Eigen::MatrixXd directions;   ///< unit, in multiples of the scales
  Eigen::MatrixXd covariance;   ///< of the multiples; not finite where information is missing
  Eigen::MatrixXd correlation;  ///< likewise
  std::vector<Knowledge> of;    ///< the parameters
};

/// @param root as of InformationFilter
/// @param inflation factor on every standard deviation
Identifiability identify(const Eigen::MatrixXd& root, double inflation);

}  // namespace gyrotwin::calibration
