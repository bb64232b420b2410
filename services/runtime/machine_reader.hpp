// What a rig file says of the machine itself, its masses and dimensions.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/runtime/rig.hpp"
#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

inline constexpr std::array<Word<model::Mount>, 3> kMountWords{
    {{"level", model::Mount::kLevel},
     {"universal_joint", model::Mount::kUniversalJoint},
     {"rigid", model::Mount::kRigid}}};

inline constexpr std::array<Word<model::TrackKind>, 3> kTrackWords{
    {{"none", model::TrackKind::kNone},
     {"lower", model::TrackKind::kLower},
     {"slot", model::TrackKind::kSlot}}};

using MachineParameters = decltype(Rig::machine);
using CoordinateNames = std::vector<std::string_view>;

/// Reads `machine` of the table [rig] and the tables that this kind of machine has, and notes what
/// does not go together.
MachineParameters read_machine(TomlReader& reader, TomlReader::Table& identity);

/// Of the machine's coordinates, in order.
CoordinateNames coordinate_names(const MachineParameters& machine);

/// The key that decides about the coordinates.
std::string machine_key(const MachineParameters& machine);

/// A number as messages show it.
std::string rounded(double x);

}  // namespace gyrotwin
