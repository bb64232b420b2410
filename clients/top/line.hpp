// Lines of character cells with tones: what is drawn, before it becomes bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// What a cell is to the reader; a terminal decides how that looks.
enum class Tone : std::uint8_t { kPlain, kFaint, kTitle, kGood, kWarning, kBad };

struct Cell {
  char32_t glyph = U' ';
  Tone tone = Tone::kPlain;
  bool operator==(const Cell&) const = default;
};

class Line {
 public:
  /// Appends text of the ASCII characters.
  Line& put(std::string_view ascii, Tone tone = Tone::kPlain);
  Line& put(char32_t glyph, std::size_t times, Tone tone = Tone::kPlain);
  Line& put(const Line& other);
  /// Appends blanks up to a column; one at least, unless the line is empty.
  Line& tab(std::size_t column);
  /// Appends `filler` up to `columns`; cuts what goes beyond, which `mark` in the last column
  /// tells.
  Line& fit(std::size_t columns, char32_t mark, Cell filler = {});

  std::size_t width() const { return cells_.size(); }
  std::span<const Cell> cells() const { return cells_; }
  bool operator==(const Line&) const = default;

 private:
  std::vector<Cell> cells_;
};

using Lines = std::vector<Line>;

/// The characters that draw, which the user's locale decides.
struct Glyphs {
  bool unicode = false;
  char32_t full() const { return unicode ? U'█' : U'#'; }
  char32_t stale() const { return unicode ? U'▒' : U':'; }
  char32_t empty() const { return unicode ? U'·' : U'.'; }
  char32_t middle() const { return unicode ? U'│' : U'|'; }
  char32_t rule() const { return unicode ? U'─' : U'-'; }
  char32_t more() const { return unicode ? U'…' : U'>'; }
};

/// As UTF-8 without tones, and without blanks at the end.
std::string text_of(const Line& line);
/// As UTF-8 with the escape sequences of a terminal. Without colour, tones are bold, faint and
/// reverse.
std::string ansi_of(const Line& line, bool colour);

/// What turns `before` on a terminal's screen into `after`: the lines that differ. Lines are as
/// wide as the screen, or the screen is blank.
std::string ansi_update(const Lines& before, const Lines& after, bool colour);

}  // namespace gyrotwin
