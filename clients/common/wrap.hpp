// Text in lines of a given width.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace gyrotwin {

/// Cuts text into lines at blanks, none longer than `columns` unless a word is.
inline std::vector<std::string> wrap(const std::string& text, std::size_t columns) {
  std::vector<std::string> parts{""};
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, to - from);
    if (!parts.back().empty() && parts.back().size() + 1 + word.size() > columns) {
      parts.emplace_back();
    }
    parts.back() += (parts.back().empty() ? "" : " ") + word;
    from = to + 1;
  }
  return parts;
}

/// The text in such lines, the first indented, the others by `hanging` more.
inline std::string paragraph(const std::string& text, std::size_t columns, std::size_t indent,
                             std::size_t hanging = 0) {
  std::string lines, blanks(indent, ' ');
  for (const std::string& line : wrap(text, columns - indent - hanging)) {
    lines += blanks + line + '\n';
    blanks.resize(indent + hanging, ' ');
  }
  return lines;
}

}  // namespace gyrotwin
