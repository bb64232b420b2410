// The pictures of a sweep.
#pragma once

#include <string>
#include <vector>

#include "clients/sweep/results.hpp"

namespace gyrotwin {

struct CaptionedSvg {
  std::string svg, caption;
};

/// How a factor goes with what becomes of the runs: rank correlations, not finite where there is
/// none.
struct Influence {
  double standing = 0.0;  ///< with standing (1) or not (0)
  double tilt = 0.0;      ///< with the largest tilt
  std::size_t runs = 0;   ///< that count
  bool by_size = false;   ///< of the factor's magnitude, which tells more than its sign

  /// The larger magnitude; 0: nothing can be told.
  double strength() const;
  /// Chance alone makes no more of it in 95 of 100 cases (normal approximation), and it does not
  /// read as 0.00.
  bool matters() const;
};
Influence influence(const Factor& factor, const Results& results);

/// Factors that are numbers and not all the same, the most influential first.
std::vector<const Factor*> by_influence(const Results& results);

/// A map over two lists, curves over one, shares and scatter over what was drawn, and how far the
/// standing ones tilt.
/// @param fall_tilt [rad]
std::vector<CaptionedSvg> summary_charts(const Results& results, double fall_tilt);

}  // namespace gyrotwin
