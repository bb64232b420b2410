// The steady upright motion of a rig.
#pragma once

#include "services/controller/law.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// A motion in which nothing changes but the disc's angle (the gyroscope's precession angle).
struct SteadyMotion {
  model::State state;
  LawState memory = LawState::Zero();
  DriveTorques torque{};
  bool coasts = false;    ///< no law: the disc's speed is taken as it is at the start
  double residual = 0.0;  ///< what is left of q'' and of the law's z' [rad/s^2]
  bool found = false;     ///< the residual is but rounding
};

/// @param law null: the drives give nothing
SteadyMotion steady_motion(const Rig& rig, const model::Machine& machine, const Law* law);

}  // namespace gyrotwin
