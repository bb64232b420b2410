// The ring of an umbrella rig from its parameters, for the engines that the model is compared with.
#pragma once

#include <cmath>

#include "services/model/umbrella.hpp"

namespace gyrotwin {

/// Its height is that of an axle tip that touches the untilted ring. @pre the rig has a track
inline model::Track umbrella_track(const model::UmbrellaParameters& p) {
  model::Track track{};
  track.tip = p.gyros.axle_length;
  track.height = p.disc.joint_height + p.gyros.pivot_height +
                 p.gyros.axle_length * std::sin(p.gyros.ring_elevation);
  if (p.track == model::TrackKind::kSlot) track.clearance = p.contact.slot_clearance;
  track.stiffness = p.contact.stiffness;
  track.damping = p.contact.damping;
  track.rolling_drag = p.contact.rolling_drag;
  return track;
}

}  // namespace gyrotwin
