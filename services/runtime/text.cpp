#include "services/runtime/text.hpp"

#include <algorithm>

namespace gyrotwin {

void write_text(std::span<std::uint8_t> field, fmt::string_view format,
                fmt::format_args args) noexcept {
  std::ranges::fill(field, std::uint8_t{0});
  try {
    fmt::vformat_to_n(field.begin(), field.size() - 1, format, args);
  } catch (...) {
    field[0] = 0;  // an empty text is better than a dead tick thread
  }
}

std::string get_text(std::span<const std::uint8_t> field) {
  std::string text(field.begin(), std::find(field.begin(), field.end(), 0));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

}  // namespace gyrotwin
