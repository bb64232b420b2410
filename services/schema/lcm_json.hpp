// Messages from JSON, for who speaks no LCM.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "services/schema/lcm_type.hpp"

namespace gyrotwin {

/// The payload, fingerprint included, of a message of this type whose fields an object names.
/// Integers may be the name of one of the type's constants, `"ARM"`, or digits in quotes where they
/// are too large for a JSON number. What the object does not name is 0.
/// @throws Error naming the field, what was found there and what it takes
std::vector<std::uint8_t> payload_from_json(const LcmType& type, const nlohmann::json& object);

}  // namespace gyrotwin
