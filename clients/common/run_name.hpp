// A run for people.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdint>
#include <string>

namespace gyrotwin {

/// "75cf128d": of its epoch the first half, which tells runs apart.
inline std::string run_name(std::int64_t epoch) {
  return fmt::format("{:08x}", static_cast<std::uint64_t>(epoch) >> 32);
}

}  // namespace gyrotwin
