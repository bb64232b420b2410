// Scenario files: a list of events with their times, played to a live owner or simulated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "clients/common/event.hpp"

namespace gyrotwin {

/// One [[event]].
struct PlannedEvent {
  AskedEvent event;
  double at_s = 0.0;  ///< since the scenario's first tick [s]
  std::string place;  ///< "scenario.toml:12", for messages
};

/// A scenario's text, and what to call it in messages.
struct ScenarioFile {
  std::string source, document;
};

/// @param name_or_path a path (it has a '/' or ends in .toml) or the bare name of a shipped one
/// @throws Error when there is no such file, naming the shipped ones
ScenarioFile open_scenario(const std::string& name_or_path);

/// Reads a scenario: TOML with nothing but [[event]] tables, each with `kind`, `at_s`, and the
/// numbers of that kind under their names with units.
/// @param overrides `eventN.key=value` texts, N from 1 in the order of the file; later ones win
/// @return in order of time, those of the same time in the order of the file
/// @throws Error listing all mistakes, each on a line `source:line:col: error: ...` with the fix
std::vector<PlannedEvent> read_scenario(std::string_view document, const std::string& source,
                                        const std::vector<std::string>& overrides = {});

/// read_scenario() of open_scenario().
std::vector<PlannedEvent> load_scenario(const std::string& name_or_path);

/// The request for one event.
/// @param tick_ns period of the owner's tick [ns]
/// @param first_tick the scenario's; nothing begins before tick 1
request_t request_of(const PlannedEvent& planned, const Rig& rig, std::int64_t tick_ns,
                     std::int64_t first_tick);

}  // namespace gyrotwin
