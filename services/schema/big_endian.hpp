// Numbers as LCM lays them out: big endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace gyrotwin {

/// The number at `at`; all of its bytes must be there.
template <class Unsigned>
Unsigned big_endian(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) value = value << 8 | bytes[at + i];
  return static_cast<Unsigned>(value);
}

/// Writes `value` to the bytes at `to`.
template <class Unsigned>
void put_big_endian(Unsigned value, std::uint8_t* to) noexcept {
  std::uint64_t rest = value;
  for (std::size_t i = sizeof(Unsigned); i-- > 0; rest >>= 8) {
    to[i] = static_cast<std::uint8_t>(rest);
  }
}

}  // namespace gyrotwin
