// The parameters that make the model say what the sensors said: multiple shooting, solved by Ceres.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "clients/calibrate/family.hpp"
#include "clients/calibrate/information.hpp"
#include "clients/calibrate/segment.hpp"

namespace gyrotwin::calibration {

/// Where a search stands.
struct FitProgress {
  bool parameters_free;  ///< false: only states and biases yet
  int iteration;
  double chi_square;
};

struct FitOptions {
  int threads = 1;
  int iterations = 60;  ///< at most, of each of the two searches
  /// Relative standard deviation of what the rig file says: a weak belief, which keeps what the
  /// data do not tell near it. What the data tell is not counted with it.
  double belief = 1.0;
  /// Told after every step. @return whether to go on
  std::function<bool(const FitProgress&)> progress = [](const FitProgress&) { return true; };
};

/// One comparison, for pictures.
struct Point {
  const Stretch* stretch;
  double t;  ///< of its run [s]
  int reading;
  double measured, predicted, sigma;  ///< predicted with its bias
};

/// How well the model says what the sensors said.
struct Agreement {
  std::vector<Point> points;  ///< all rows
  double chi_square = 0.0;    ///< of all rows

  /// Root mean square of (predicted - measured) / sigma; 1 where model and sigma are right.
  double rms(int reading) const;
  std::vector<int> readings() const;  ///< that there are, ascending
};

struct Fit {
  std::vector<double> x;     ///< of the parameters, in multiples of their scales
  std::vector<double> bias;  ///< of each Bias
  std::vector<Bias> biases;
  Agreement before, after;      ///< states and biases are the best ones in both
  double freedom = 0.0;         ///< rows minus unknowns that the rows alone decide
  Eigen::MatrixXd information;  ///< root, see InformationFilter
  std::string ending;           ///< why the search ended
  int iterations = 0;

  /// chi^2 over degrees of freedom; 1 where the model and [sensors] are right.
  double reduced_chi_square() const { return after.chi_square / freedom; }
  /// Factor on standard deviations that the remaining disagreement asks for.
  double inflation() const;
};

/// @param rig where the search begins, as of the family
/// @throws NotDone when the model cannot be followed, or the search does not converge
Fit fit(const Family& family, const Rig& rig, const std::vector<Stretch>& stretches,
        const Cuts& cuts, const FitOptions& options);

}  // namespace gyrotwin::calibration
