// What a rig file says, key by key. deploy/rigs/README.md lists the same keys for people.
#pragma once

#include <array>
#include <vector>

#include "services/runtime/rig.hpp"
#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

inline constexpr std::array<Word<LawKind>, 9> kLawWords{{
    {"none", LawKind::kNone},
    {"open_loop", LawKind::kOpenLoop},
    {"constant_speed", LawKind::kConstantSpeed},
    {"tilt_to_speed", LawKind::kTiltToSpeed},
    {"momentum_manager", LawKind::kMomentumManager},
    {"reduced_lqr", LawKind::kReducedLqr},
    {"precession", LawKind::kPrecession},
    {"shelf", LawKind::kShelf},
    {"precession_lqr", LawKind::kPrecessionLqr},
}};

/// Reads every key of a rig and notes what does not go together; reader.finish() then tells.
Rig read_rig(TomlReader& reader);

/// The keys of a rig with this `rig.machine` and every table that may be left out; what optional
/// ones are by default is their value.
std::vector<TomlReader::Key> rig_keys(const std::string& machine);

}  // namespace gyrotwin
