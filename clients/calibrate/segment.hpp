// A piece of a run that is shot through on its own: it starts from a state that is unknown too, and
// must end where the next one starts.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "clients/calibrate/readings.hpp"
#include "clients/calibrate/recording.hpp"

namespace gyrotwin::calibration {

/// What is compared, and where the runs are cut.
struct Cuts {
  double length_s = 0.2;          ///< of a segment; the model's error grows within
  int every = 1;                  ///< only each so many ticks' sensors count
  std::vector<SensorKind> use{};  ///< none: all
};

/// One reading that counts.
struct Row {
  std::size_t moment;  ///< of the stretch
  int reading;
  double value, sigma;
  int bias;  ///< which of the biases it has; -1: none
};

struct Segment {
  const Stretch* stretch;
  std::size_t first, last;  ///< moments; the last one begins the next segment
  bool continued;           ///< there is a next segment, which its end must meet
  model::RotorSpeeds held;  ///< rotor speeds where they are no part of the state [rad/s]
  Eigen::VectorXd start;    ///< a first guess, packed
  std::vector<Row> rows;

  /// Residuals, continuity included.
  Eigen::Index size() const {
    return static_cast<Eigen::Index>(rows.size()) + (continued ? start.size() : 0);
  }
};

/// Segments that a search finds its way through: bouncing axles forget in a few bounces where they
/// started [s].
double default_length(const model::Machine& machine);

/// A constant offset of one reading, sought beside the parameters.
struct Bias {
  int reading;
  double sigma;  ///< by the rig file: how large it is likely to be
};

/// How far the end of a segment may be from the start of the next, one standard deviation: well
/// below what a segment's readings tell, and above what the solver errs.
inline constexpr double kSeam = 1e-6;  // [rad], and [rad/s] by 10 and rotors by 1e4

/// Cuts stretches into segments and guesses where they start.
/// @param rig, machine where the search begins
/// @param stretches outlive the segments
/// @param biases filled with those that the readings need
std::vector<Segment> cut(const Rig& rig, const model::Machine& machine,
                         const std::vector<Stretch>& stretches, const Cuts& cuts,
                         std::vector<Bias>& biases);

/// What the model makes of the segment.
struct Shot {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::VectorXd residual;     ///< (predicted + bias - measured) / sigma, then the seam's / kSeam
  Rows by_start, by_parameter;  ///< derivatives, where they were asked for
};
/// The seam's residual hangs on the next start by -1 / seam_sigma(i), a row's on its bias by
/// 1 / sigma.
/// @param next where the next segment starts; empty without one
/// @return false when the model cannot be followed from there
bool shoot(const Segment& segment, const Neighbourhood& around, const Rig::Sensors& sensors,
           std::span<const double> start, std::span<const double> next,
           std::span<const double> biases, bool derivatives, Shot& shot);

/// Of entry i of a packed state of a machine with n coordinates.
double seam_sigma(Eigen::Index i, int n);

/// The input of a moment for a machine: where currents tell the torques, by its motor constants.
model::Input input_of(const Moment& moment, const model::Machine& machine);

}  // namespace gyrotwin::calibration
