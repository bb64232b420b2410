// Requests in words, for people.
#pragma once

#include <string>

#include "messages/channels.hpp"

namespace gyrotwin {

/// What a DISTURB or FAULT does: "load: moment (5, 0, 0) N m", "gyro stuck", "drive 0: 30 % left".
std::string describe(const request_t& request);

}  // namespace gyrotwin
