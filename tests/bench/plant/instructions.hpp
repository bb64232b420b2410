// Instructions of an acceleration, counted by valgrind: what a shared machine cannot disturb.
#pragma once

#include <string>
#include <vector>

namespace gyrotwin::bench {

/// Runs this program once more, under callgrind, and prints what every subject of those rigs takes
/// for one acceleration.
/// @throws Error when valgrind is not there or fails
void count_instructions(const std::vector<std::string>& rigs);

/// What that run does: each subject's pass over the samples, counted and dumped by itself.
void pass_under_callgrind(const std::vector<std::string>& rigs);

}  // namespace gyrotwin::bench
