#include "clients/top/line.hpp"

#include <algorithm>

namespace gyrotwin {

namespace {

void append_utf8(std::string& text, char32_t glyph) {
  const auto byte = [&text](char32_t bits) { text += static_cast<char>(bits); };
  if (glyph < 0x80) return byte(glyph);
  if (glyph < 0x800) {
    byte(0xc0 | (glyph >> 6));
    return byte(0x80 | (glyph & 0x3f));
  }
  byte(0xe0 | (glyph >> 12));
  byte(0x80 | ((glyph >> 6) & 0x3f));
  byte(0x80 | (glyph & 0x3f));
}

std::string_view attributes(Tone tone, bool colour) {
  switch (tone) {
    case Tone::kFaint:
      return "\x1b[2m";
    case Tone::kTitle:
      return "\x1b[1m";
    case Tone::kGood:
      return colour ? "\x1b[32m" : "";
    case Tone::kWarning:
      return colour ? "\x1b[1;33m" : "\x1b[1m";
    case Tone::kBad:
      return colour ? "\x1b[1;31m" : "\x1b[7m";
    case Tone::kPlain:
      break;
  }
  return "";
}

}  // namespace

Line& Line::put(std::string_view ascii, Tone tone) {
  for (const char c : ascii) {
    // What is not ASCII would be more or less than one column wide.
    cells_.push_back({c < ' ' || c > '~' ? U'?' : static_cast<char32_t>(c), tone});
  }
  return *this;
}

Line& Line::put(char32_t glyph, std::size_t times, Tone tone) {
  cells_.insert(cells_.end(), times, {glyph, tone});
  return *this;
}

Line& Line::put(const Line& other) {
  cells_.insert(cells_.end(), other.cells_.begin(), other.cells_.end());
  return *this;
}

Line& Line::tab(std::size_t column) {
  const std::size_t least = cells_.empty() ? 0 : cells_.size() + 1;
  cells_.resize(std::max(column, least));
  return *this;
}

Line& Line::fit(std::size_t columns, char32_t mark, Cell filler) {
  const bool cut = cells_.size() > columns;
  cells_.resize(columns, filler);
  if (cut && columns > 0) cells_.back() = {mark, Tone::kFaint};
  return *this;
}

std::string text_of(const Line& line) {
  std::string text;
  for (const Cell& cell : line.cells()) append_utf8(text, cell.glyph);
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string ansi_of(const Line& line, bool colour) {
  std::string text;
  std::string_view current;
  for (const Cell& cell : line.cells()) {
    const std::string_view wanted = attributes(cell.tone, colour);
    if (wanted != current) {
      if (!current.empty()) text += "\x1b[0m";
      text += wanted;
      current = wanted;
    }
    append_utf8(text, cell.glyph);
  }
  if (!current.empty()) text += "\x1b[0m";
  return text;
}

std::string ansi_update(const Lines& before, const Lines& after, bool colour) {
  std::string text;
  for (std::size_t row = 0; row < after.size(); ++row) {
    if (row < before.size() && before[row] == after[row]) continue;
    text += "\x1b[" + std::to_string(row + 1) + ";1H" + ansi_of(after[row], colour);
  }
  return text;
}

}  // namespace gyrotwin
