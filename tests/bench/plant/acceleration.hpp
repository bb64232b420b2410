// Accelerations beside the peers': agreement, time, instructions.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/plant/scenario.hpp"
#include "tests/bench/plant/timing.hpp"

namespace gyrotwin::bench {

/// One machine in every engine that has it, and the states it is measured at.
struct Contest {
  std::string rig;
  std::vector<Sample> samples;
  std::vector<std::unique_ptr<Peer>> subjects;  ///< loaded with the samples; first: gyrotwin
};

/// The rigs that are measured, those without peers included.
const std::vector<std::string>& contest_rigs();

/// With peers: prints how far each one's accelerations are from the model's, and leaves out, with
/// a word on stderr, whoever is further than kAgreement.
Contest contest(const std::string& rig, bool peers = true);
inline constexpr double kAgreement = 1e-3;

/// Of a subject that has its samples.
Turn turn_of(Peer& subject);

/// Times all subjects in turns, for so long [s]; prints p50.
void time_accelerations(Contest& contest, double seconds);

}  // namespace gyrotwin::bench
