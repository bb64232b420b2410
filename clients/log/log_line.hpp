// Events of a log as lines of text.
#pragma once

#include <string>

#include "clients/log/catalog.hpp"

namespace gyrotwin {

/// One event as a line, without the newline.
/// @param seconds since the first message
std::string short_line(const Catalog& catalog, const LogEvent& event, double seconds);
std::string json_line(const Catalog& catalog, const LogEvent& event, double seconds);

}  // namespace gyrotwin
