// ASCII text in a message's fixed byte field.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace gyrotwin {

/// set_text() for fields of all lengths.
/// @pre !field.empty()
void write_text(std::span<std::uint8_t> field, fmt::string_view format,
                fmt::format_args args) noexcept;

/// Formats into the field, cut to fit, padded with NULs; the last byte stays NUL. Does not allocate
/// for numbers and strings.
template <std::size_t N, class... Args>
void set_text(std::uint8_t (&field)[N], fmt::format_string<Args...> format,
              Args&&... args) noexcept {
  write_text(field, format, fmt::make_format_args(args...));
}

/// The text up to its first NUL, as it is: for what this program wrote, or to be cleaned by the
/// log.
template <std::size_t N>
std::string_view text_view(const std::uint8_t (&field)[N]) noexcept {
  const auto* end = std::find(std::begin(field), std::end(field), std::uint8_t{0});
  return {reinterpret_cast<const char*>(field), static_cast<std::size_t>(end - field)};
}

/// The text up to its first NUL, other control characters and non-ASCII shown as '?'.
std::string get_text(std::span<const std::uint8_t> field);

}  // namespace gyrotwin
