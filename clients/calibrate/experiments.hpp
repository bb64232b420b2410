// The experiments that tell a rig's parameters, and which tells which.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// One kind of experiment.
struct ExperimentKind {
  std::string_view name;     ///< on the command line
  std::string_view does;     ///< for --help
  std::string_view because;  ///< what makes it tell what it tells
  bool structure_pinned;     ///< upright
  bool disc_pinned;          ///< to the structure
  bool rotors_at_rest;
  bool axles_lifted;  ///< off their ring, where there is one: nothing bounces
};

inline constexpr std::array<ExperimentKind, 4> kExperiments{{
    {.name = "coast-down",
     .does = "structure pinned, rotors at rest; the disc driven by a known torque, then left alone",
     .because = "what the drive's torque does to the disc alone, and how it comes to rest without",
     .structure_pinned = true,
     .disc_pinned = false,
     .rotors_at_rest = true,
     .axles_lifted = true},
    {.name = "swing",
     .does = "rotors at rest, a known counterweight below the pivot: it swings as a pendulum",
     .because = "two periods, with two counterweights one after the other",
     .structure_pinned = false,
     .disc_pinned = false,
     .rotors_at_rest = true,
     .axles_lifted = true},
    {.name = "run-down",
     .does = "structure and disc pinned; the rotors lose their power",
     .because = "how the rotors' speeds fall without power",
     .structure_pinned = true,
     .disc_pinned = true,
     .rotors_at_rest = false,
     .axles_lifted = true},
    {.name = "free-run",
     .does = "balancing, driven or pushed as well as it bears",
     .because = "how the gyros answer while it balances",
     .structure_pinned = false,
     .disc_pinned = false,
     .rotors_at_rest = false,
     .axles_lifted = false},
}};

/// @throws Error when there is none of this name
const ExperimentKind& experiment_of(std::string_view name);

/// How long to watch so that it tells them [s, of the owner's time]: a run-down until the rotors
/// have lost half their speed, so that drag that grows with speed and drag that does not are told
/// apart.
double watched_s(const ExperimentKind& kind, const Rig& rig);

/// Keys that an experiment on a rig tells and that are asked for by default; none of a
/// [rotor_drive] that the rig file lacks.
std::vector<std::string> keys_of(const ExperimentKind& kind, const Rig& rig);

/// Overrides of the rig file that make the model as the rig is for an experiment: what is pinned is
/// too heavy to be moved within an hour. A simulated rig is pinned by the same.
std::vector<std::string> arrangement(const ExperimentKind& kind, const Rig& rig);

/// The experiment that tells a key best; null where none of them does.
const ExperimentKind* best_for(std::string_view key);

}  // namespace gyrotwin
