// Rig files as texts, for tests that spoil them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"

namespace gyrotwin::support {

using Strings = std::vector<std::string>;

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline Strings lines_of(const std::string& text) {
  Strings lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What a rig read from this text and these overrides is blamed for, one mistake an entry.
inline Strings mistakes_in(const std::string& text, const Strings& overrides = {}) {
  try {
    TomlReader reader(text, "r.toml", overrides);
    read_rig(reader);
    reader.finish();
  } catch (const Error& error) {
    Strings lines = lines_of(error.what());
    EXPECT_EQ(lines.front(),
              std::string_view(error.what()).find("\n--set ") != std::string_view::npos
                  ? "r.toml, as --set changes it, cannot be used:"
                  : "r.toml cannot be used:");
    lines.erase(lines.begin());
    return lines;
  }
  return {};
}

/// A shipped rig with one text replaced by another.
inline std::string edited(const std::string& rig, const std::string& from, const std::string& to) {
  std::string text = text_of(rig_folder() / (rig + ".toml"));
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// "r.toml:LINE:" of the first line that begins with `start`, after the header of `table`.
inline std::string line_of(const std::string& text, const std::string& table,
                           const std::string& start) {
  const Strings lines = lines_of(text);
  bool inside = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == '[' + table + ']') inside = true;
    if (inside && lines[i].starts_with(start)) return "r.toml:" + std::to_string(i + 1) + ':';
  }
  ADD_FAILURE() << table << ' ' << start;
  return {};
}

}  // namespace gyrotwin::support
