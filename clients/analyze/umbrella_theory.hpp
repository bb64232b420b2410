// The umbrella platform's formulas.
#pragma once

#include "clients/analyze/conditions.hpp"

namespace gyrotwin {

/// @param p the rig's
Theory umbrella_theory(const Rig& rig, const model::UmbrellaParameters& p,
                       const std::optional<LinearModel>& linear);

}  // namespace gyrotwin
