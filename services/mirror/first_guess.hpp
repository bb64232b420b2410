// Where a rig is that has just been met: what its first SENSORS say, and how sure that is.
#pragma once

#include "services/mirror/prediction.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

struct FirstGuess {
  model::State state;       ///< at nominal rotor speeds
  Prediction::Point sigma;  ///< standard deviations of (q, v) [rad], [rad/s]
};

/// At tick 0 at rest (HELD), at a later tick anywhere in a swing. Of sensors that say nothing the
/// rig's initial state stands.
/// @pre rig.sensors
FirstGuess first_guess(const Rig& rig, const model::Machine& machine,
                       const sensors_t& first) noexcept;

}  // namespace gyrotwin
