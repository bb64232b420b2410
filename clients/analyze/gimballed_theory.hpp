// The formulas of gimballed machines and of the gyroscope.
#pragma once

#include "clients/analyze/conditions.hpp"

namespace gyrotwin {

/// @param p the rig's
Theory gimballed_theory(const Rig& rig, const model::GimballedParameters& p);
/// @param p the rig's
Theory gyroscope_theory(const Rig& rig, const model::GyroscopeParameters& p);

}  // namespace gyrotwin
