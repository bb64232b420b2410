// STATUS as JSON, for programs. Identities are texts, since 63 bits are more than a JSON number
// holds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "messages/channels.hpp"

namespace gyrotwin {

using Json = nlohmann::ordered_json;

/// What every daemon says of itself.
Json daemon_json(const status_t& status);

/// The line of a real plant's owner to its device.
Json link_json(const link_t& link);

/// What an owner says. @param lease who holds it, in words
Json owner_json(const status_t& status, const std::string& lease);

}  // namespace gyrotwin
