// Numbers as LCM lays them out: big endian.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gyrotwin {

/// From the host's order of bytes to LCM's, and back. By builtins: GCC does not take a loop over
/// bytes for one instruction.
template <std::unsigned_integral Unsigned>
Unsigned in_big_endian(Unsigned value) noexcept {
  if constexpr (std::endian::native == std::endian::big || sizeof value == 1) {
    return value;
  } else if constexpr (sizeof value == 2) {
    return __builtin_bswap16(value);
  } else if constexpr (sizeof value == 4) {
    return __builtin_bswap32(value);
  } else {
    static_assert(sizeof value == 8);
    return __builtin_bswap64(value);
  }
}

/// The number at `at`; all of its bytes must be there.
template <std::unsigned_integral Unsigned>
Unsigned big_endian(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  Unsigned value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return in_big_endian(value);
}

/// Writes `value` to the bytes at `to`.
template <std::unsigned_integral Unsigned>
void put_big_endian(Unsigned value, std::uint8_t* to) noexcept {
  value = in_big_endian(value);
  std::memcpy(to, &value, sizeof value);
}

}  // namespace gyrotwin
