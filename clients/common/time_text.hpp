// Times for people.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <string>

namespace gyrotwin {

/// "3.2 s", "12 min", "1.8 h".
inline std::string time_text(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.3g} h", seconds / 3600.0);
}

}  // namespace gyrotwin
