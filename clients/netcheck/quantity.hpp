// Numbers as this program shows them.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdint>
#include <string>

namespace gyrotwin::netcheck {

/// "0", "503 (5.03 %)".
inline std::string count_text(std::int64_t count, std::int64_t of) {
  if (count == 0 || of == 0) return fmt::format("{}", count);
  return fmt::format("{} ({:.2g} %)", count,
                     100.0 * static_cast<double>(count) / static_cast<double>(of));
}

/// "8.4 MB".
inline std::string bytes_text(std::int64_t bytes) {
  if (bytes < 1'000'000) return fmt::format("{:.3g} kB", 1e-3 * static_cast<double>(bytes));
  return fmt::format("{:.3g} MB", 1e-6 * static_cast<double>(bytes));
}

/// "1.3 %".
inline std::string share_text(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

}  // namespace gyrotwin::netcheck
