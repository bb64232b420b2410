// gyrotwin log plot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clients/log/selection.hpp"

namespace gyrotwin {

struct PlotOptions {
  std::filesystem::path file;
  std::filesystem::path output;     ///< empty: that of the log, ending .svg, in this folder
  std::vector<std::string> fields;  ///< LIVE/STATE.tilt_rad[0]; without an index: all elements
  double from_s = 0.0, to_s = 1e12;
  bool force = false;  ///< replace the file that is there
};

/// Draws fields over time as SVG, a panel a unit. Without fields: tilt, disc and gimbals, and
/// torque of LIVE/STATE, as far as the rig has them.
/// @return exit code @throws Error, NotDone
int plot_log(const PlotOptions& options);

}  // namespace gyrotwin
