// An analysis as one HTML page.
#pragma once

#include <string>
#include <vector>

#include "clients/analyze/analysis.hpp"
#include "clients/analyze/figures.hpp"

namespace gyrotwin {

/// Verdict and reason, conditions, pictures, limits, numbers; self-contained.
std::string report_html(const Rig& rig, const Analysis& analysis,
                        const std::vector<Figure>& figures);

}  // namespace gyrotwin
