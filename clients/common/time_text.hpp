// Times for people.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdint>
#include <string>

namespace gyrotwin {

/// "3.2 s", "12 min", "1.8 h".
inline std::string time_text(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.3g} h", seconds / 3600.0);
}

/// "12.3 us", "1.5 ms", "3 s".
inline std::string time_text_ns(std::int64_t ns) {
  const auto value = static_cast<double>(ns);
  const double size = std::abs(value);
  if (size < 999.5e3) return fmt::format("{:.3g} us", 1e-3 * value);
  if (size < 999.5e6) return fmt::format("{:.3g} ms", 1e-6 * value);
  return fmt::format("{:.4g} s", 1e-9 * value);
}

}  // namespace gyrotwin
