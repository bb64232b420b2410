// This program once more under callgrind, which counts what a shared machine cannot disturb:
// instructions, and which.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gyrotwin::bench {

/// One subject's pass over the samples of a rig.
struct Pass {
  std::string rig, subject;
  double instructions = 0.0;  ///< of one acceleration
  /// Of this program's own code, how often each instruction is executed in one acceleration, by
  /// its address in the file.
  std::map<std::uint64_t, double> executed;
};

/// @param peers whether they pass too
/// @throws Error when valgrind is not there or fails
std::vector<Pass> passes_under_callgrind(const std::vector<std::string>& rigs, bool peers);

/// What runs there: each subject's pass, counted by itself.
void pass_under_callgrind(const std::vector<std::string>& rigs, bool peers);

/// Prints the instructions of every subject of those rigs.
void count_instructions(const std::vector<std::string>& rigs);

/// Of this program. @throws Error without /proc
std::string own_path();
/// Runs a program. @return what it has printed @throws Error when it is not there or fails
std::string output_of(const std::vector<std::string>& words);

}  // namespace gyrotwin::bench
