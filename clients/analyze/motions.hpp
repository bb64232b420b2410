// Charts of motions: after a push, from many starts, and in which potential.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/analyze/analysis.hpp"
#include "clients/plot/chart.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// A chart and what to say under it.
struct CaptionedChart {
  Chart chart;
  std::string caption;
};

/// Tilt, disc speed or gimbal angles, and drive torques after the reference push, under the law and
/// with the drives left alone.
std::vector<CaptionedChart> response_charts(const Rig& rig, const Analysis& analysis, int threads);

/// Tilt rate over tilt from a ring of starts in roll; none without a tilt.
std::optional<CaptionedChart> phase_portrait(const Rig& rig, int threads);

/// Of the undriven frictionless machine, over the tilt; none without a tilt. Derivation:
/// services/model/README.md, section 4.
std::optional<CaptionedChart> amended_potential(const Rig& rig);

}  // namespace gyrotwin
