// A run of a rig, kept for a picture.
#pragma once

#include <functional>
#include <vector>

#include "clients/simulate/simulation.hpp"

namespace gyrotwin {

/// Quantities over a run, one vector each.
using Columns = std::vector<std::vector<double>>;
/// What is kept of an instant.
using Look = std::function<std::vector<double>(const Sample&)>;

/// Some 2000 instants of a run, or every tick of it, evenly spaced, until its end or until it has
/// lain down.
Columns record(const Rig& rig, const model::Machine& machine, Scenario scenario, const Look& look,
               bool every_tick = false);

}  // namespace gyrotwin
