// The lines of a sweep, read back.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clients/sweep/variable.hpp"

namespace gyrotwin {

/// Verdicts as they stand in runs.csv.
inline constexpr std::string_view kStands = "stands", kGrowing = "growing", kLeans = "leans",
                                  kFalls = "falls", kFailed = "failed", kImpossible = "impossible";

/// A value that runs differ in.
struct Factor {
  std::string key;
  bool drawn = false;
  bool quantity = true;            ///< more or less of it means something: not a seed
  std::vector<std::string> texts;  ///< by run
  std::vector<double> numbers;     ///< by run; empty when one of the texts is no number
  /// The distinct numbers, ascending.
  std::vector<double> levels() const;
  /// |key|, with the numbers' magnitudes.
  Factor sizes() const;
};

/// All runs of a sweep, column by column; numbers that were left empty are not finite.
struct Results {
  std::vector<Factor> factors;
  std::vector<std::string> verdicts;
  std::vector<double> fell_at, largest_tilt;  // [s], [rad]

  std::size_t runs() const { return verdicts.size(); }
  /// To the end; neither one that still tilts further nor one that leans on its stops.
  bool stands(std::size_t run) const { return verdicts[run] == kStands; }
  /// There is such a rig.
  bool counts(std::size_t run) const { return verdicts[run] != kImpossible; }
};

/// @param csv of Experiment::header() and lines
Results read_results(const std::string& csv, const std::vector<Variable>& variables);

}  // namespace gyrotwin
