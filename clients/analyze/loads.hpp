// Loads on a rig at a given time.
#pragma once

#include <string>

#include "clients/common/event.hpp"
#include "clients/simulate/trial.hpp"

namespace gyrotwin {

/// @param begin when it comes; the first tick at the earliest [s]
/// @param place for messages
Scenario::Event event_at(const Rig& rig, const AskedEvent& asked, double begin, std::string place);

/// As the rig would run live, with its reference push, if it has one.
/// @param push_at [s]
/// @param duration of everything [s]
Scenario push_scenario(const Rig& rig, const model::Machine& machine, double push_at,
                       double duration);

}  // namespace gyrotwin
