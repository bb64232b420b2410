// Numbers as CDR, Foxglove's protocol and MCAP lay them out: little endian.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gyrotwin {

/// Writes `value` to the bytes at `to`.
template <std::unsigned_integral Unsigned>
void put_little_endian(Unsigned value, std::uint8_t* to) noexcept {
  for (std::size_t i = 0; i < sizeof value; ++i) to[i] = static_cast<std::uint8_t>(value >> 8 * i);
}

/// Appends `value`.
template <std::unsigned_integral Unsigned>
void append_little_endian(std::vector<std::uint8_t>& to, Unsigned value) {
  to.resize(to.size() + sizeof value);
  put_little_endian(value, to.data() + to.size() - sizeof value);
}

}  // namespace gyrotwin
