// Whether a disturbance or a fault can be meant, and whether this rig can show it.
#pragma once

#include <cstdint>
#include <string_view>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

inline constexpr double kLongestDelay = 1.0;  ///< SENSOR_DELAYED [s]

/// Everything about a DISTURB or FAULT but when it begins and whether there is room for it.
/// @param sensors VALID_* that the rig has
/// @return false, with why and what to do in `reply`, when it is refused
bool check_request(const request_t& request, const Rig& rig, const model::Machine& machine,
                   std::int32_t sensors, reply_t& reply) noexcept;

}  // namespace gyrotwin
