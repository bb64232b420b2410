// What the fuzzers share.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace gyrotwin::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Ends the program where a promise is broken: the fuzzer keeps the input.
inline void require(bool holds) {
  if (!holds) std::abort();
}

inline std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Cuts the bytes up to the first `end` off `rest`, which loses them and it; all without one.
inline Bytes cut(Bytes& rest, std::uint8_t end) {
  std::size_t size = 0;
  while (size < rest.size() && rest[size] != end) ++size;
  const Bytes piece = rest.first(size);
  rest = rest.subspan(size < rest.size() ? size + 1 : size);
  return piece;
}

}  // namespace gyrotwin::fuzz
