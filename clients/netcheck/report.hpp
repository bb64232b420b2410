// What was found, for people and for programs.
#pragma once

#include <string>

#include "clients/netcheck/advice.hpp"

namespace gyrotwin::netcheck {

/// At most 80 columns, but for a name or a command that is longer.
std::string report_text(const Netcheck& check);

/// Everything, as one JSON object.
std::string report_json(const Netcheck& check);

/// "1000 Hz: 1.3 % of the ticks have no answer within 750 us (0.1 % may)": why this rate is not
/// good. @pre it is not
std::string limit_text(const Fit& fit, int timeout_ticks);

}  // namespace gyrotwin::netcheck
