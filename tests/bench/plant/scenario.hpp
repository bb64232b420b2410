// What the machines go through while they are measured: the rig's start, its reference push, and
// drives that swing.
#pragma once

#include <vector>

#include "tests/bench/plant/peer.hpp"

namespace gyrotwin::bench {

/// That of stepping_error(), with ideal torques; held over a tick.
model::Input scenario_input(const Rig& rig, const model::Machine& machine, int tick);

/// The states at so many ticks of the rig's own plant.
inline constexpr int kTrajectoryTicks = 256;
std::vector<Sample> trajectory(const Rig& rig);

/// States about the rig's start, with all rates, torques and a moment; axles in and out of contact.
std::vector<Sample> random_samples(const Rig& rig, int count);

}  // namespace gyrotwin::bench
