// Initial states on a command line: `q=0.05,0,0,0,v=0,0,-5,0` or `thx=0.05,phi_dot=-5`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// Generalised coordinates and their rates in the machine's order.
struct Initial {
  std::vector<double> q;  ///< [rad]
  std::vector<double> v;  ///< [rad/s]
};

/// `base` with what `text` says about it. `q=` and `v=` begin a list of all coordinates or all
/// rates; `NAME=` sets one coordinate, `NAME_dot=` its rate. Commas, semicolons, spaces and
/// brackets separate.
/// @param names of the coordinates, model::Layout::names
/// @param base as many coordinates and rates as names
/// @throws Error naming what was found and what the machine takes
Initial parse_initial(std::string_view text, const std::vector<std::string>& names, Initial base);

}  // namespace gyrotwin
