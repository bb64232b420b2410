// One page about a sweep.
#pragma once

#include <functional>
#include <string>

#include "clients/sweep/results.hpp"

namespace gyrotwin {

/// What a page says besides the results.
struct SummaryText {
  std::string title;                                    ///< "prototype_b in 400 runs"
  std::string about;                                    ///< what was swept, one line
  std::string caution;                                  ///< what the runs leave out; empty: nothing
  double fall_tilt;                                     ///< of the rig as it is [rad]
  std::function<std::string(std::size_t run)> repeat;   ///< command that does a run again
  std::function<std::string(std::size_t run)> refusal;  ///< why there is no such rig
};

/// "812 of 1000 runs stand: 81.2 %, with 95 % confidence 78.7 to 83.5 %"; the interval where all
/// that differs was drawn: a chosen list is no sample of anything. What neither stands nor falls,
/// and runs that are no rig, are told.
std::string standing_sentence(const Results& results, const SummaryText& text);

/// Self-contained HTML: how many stand and how sure that is, where in the swept space, what it
/// hangs on, and how to see a run again. @pre at least one run
std::string summary_html(const Results& results, const SummaryText& text);

}  // namespace gyrotwin
