// What a rig file says, key by key. deploy/rigs/README.md lists the same keys for people.
#pragma once

#include <array>
#include <vector>

#include "services/runtime/rig.hpp"
#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

inline constexpr std::array<Word<LawKind>, 5> kLawWords{{
    {"none", LawKind::kNone},
    {"constant_speed", LawKind::kConstantSpeed},
    {"momentum_manager", LawKind::kMomentumManager},
    {"reduced_lqr", LawKind::kReducedLqr},
    {"precession_lqr", LawKind::kPrecessionLqr},
}};

inline constexpr std::array<Word<model::Mount>, 3> kMountWords{
    {{"level", model::Mount::kLevel},
     {"universal_joint", model::Mount::kUniversalJoint},
     {"rigid", model::Mount::kRigid}}};

inline constexpr std::array<Word<model::TrackKind>, 3> kTrackWords{
    {{"none", model::TrackKind::kNone},
     {"lower", model::TrackKind::kLower},
     {"slot", model::TrackKind::kSlot}}};

/// Reads every key of a rig and notes what does not go together; reader.finish() then tells.
Rig read_rig(TomlReader& reader);

/// The keys of a rig with this `rig.machine`; what optional ones are by default is their value.
std::vector<TomlReader::Key> rig_keys(const std::string& machine);

}  // namespace gyrotwin
