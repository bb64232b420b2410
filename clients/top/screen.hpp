// The whole picture on a screen of some size, or as plain text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "clients/top/line.hpp"
#include "clients/top/picture.hpp"
#include "clients/top/rig_facts.hpp"

namespace gyrotwin {

struct Size {
  std::size_t rows = 24, columns = 80;
  bool operator==(const Size&) const = default;
};

/// As many lines as the screen has rows, each as wide as the screen.
Lines screen(const Picture& picture, const RigFacts& facts, Size size, Glyphs glyphs);

/// A block of text, lines as long as they need to be.
/// @param after number of the last happening that was told already
std::string plain_text(const Picture& picture, const RigFacts& facts, Glyphs glyphs,
                       std::int64_t after);

/// One object on one line. Fields end in their units; what is not known or not valid is null.
/// @param after number of the last happening that was told already
std::string json_text(const Picture& picture, const RigFacts& facts, std::int64_t after);

}  // namespace gyrotwin
