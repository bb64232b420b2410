// Where a rig is that has just been met: what its first SENSORS say, and how sure that is.
#pragma once

#include "services/mirror/prediction.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

struct FirstGuess {
  model::State state;       ///< rotor speeds: the rig's initial ones
  Prediction::Point sigma;  ///< standard deviations of (q, v) [rad], [rad/s]
};

/// At tick 0 at rest (HELD) unless the gyro turns, at a later tick anywhere in a swing, where the
/// accelerometer tells no tilt. What no sensor tells is as in the rig's initial state.
/// @pre rig.sensors
FirstGuess first_guess(const Rig& rig, const model::Machine& machine,
                       const sensors_t& first) noexcept;

}  // namespace gyrotwin
