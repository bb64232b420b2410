#include "clients/calibrate/rig_text.hpp"

#include <spdlog/fmt/fmt.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/runtime/error.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Lines with their ends, so that they can be put together again as they were.
std::vector<std::string> lines_of(std::string_view document) {
  std::vector<std::string> lines;
  while (!document.empty()) {
    const std::size_t end = std::min(document.find('\n'), document.size() - 1) + 1;
    lines.emplace_back(document.substr(0, end));
    document.remove_prefix(end);
  }
  return lines;
}

/// The table that a line begins.
std::optional<std::string> table_of(std::string_view line) {
  line = trimmed(line);
  const std::size_t end = line.find(']');
  if (!line.starts_with('[') || line.starts_with("[[") || end == std::string_view::npos) return {};
  return std::string(trimmed(line.substr(1, end - 1)));
}

/// Whether a line gives `name` a value.
bool gives(std::string_view line, std::string_view name) {
  const std::size_t equals = line.find('=');
  return equals != std::string_view::npos && trimmed(line.substr(0, equals)) == name;
}

std::string line_end_of(const std::vector<std::string>& lines) {
  return !lines.empty() && lines.front().ends_with("\r\n") ? "\r\n" : "\n";
}

/// The same line with another value; a comment that it had stands behind the new one.
std::string changed(const std::string& line, const NewValue& value) {
  const std::size_t begin = line.find_first_not_of(kBlanks, line.find('=') + 1);
  const std::size_t end = line.find_first_of(" \t\r\n#", begin);
  const std::size_t hash = line.find('#', begin);
  const std::string before = line.substr(begin, std::min(end, line.size()) - begin);
  const std::string_view old = hash == std::string::npos
                                   ? std::string_view()
                                   : trimmed(std::string_view(line).substr(hash + 1));
  const std::string_view tail = std::string_view(line);
  const std::string line_end = tail.ends_with("\r\n") ? "\r\n" : tail.ends_with('\n') ? "\n" : "";
  std::string text = line.substr(0, begin) + value.value;
  text += "  # " + value.comment + "; before: " + before;
  // A newline that the comment held is none any more.
  std::string note(old.substr(0, old.find_last_not_of("\r\n") + 1));
  if (!note.empty()) text += ", " + note;
  return text + line_end;
}

/// Lines [first, last) of a table's body; none where there is no such table.
struct Body {
  std::size_t first, last;
};
std::optional<Body> body_of(const std::vector<std::string>& lines, std::string_view table) {
  std::optional<Body> body;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto begins = table_of(lines[i]);
    if (body && (begins || trimmed(lines[i]).starts_with("[["))) break;
    if (begins == table) body = Body{i + 1, i + 1};
    // Blank lines and comments behind the last key belong to what follows.
    if (body && !begins && lines[i].find('=') != std::string::npos &&
        !trimmed(lines[i]).starts_with('#')) {
      body->last = i + 1;
    }
  }
  return body;
}

void set(std::vector<std::string>& lines, const NewValue& value) {
  const std::size_t dot = value.key.find('.');
  const std::string table = value.key.substr(0, dot);
  const std::string name = value.key.substr(dot + 1);
  const std::string line_end = line_end_of(lines);
  const std::string line =
      fmt::format("{} = {}  # {}{}", name, value.value, value.comment, line_end);
  const auto body = body_of(lines, table);
  const Body none{0, 0};
  for (std::size_t i = body.value_or(none).first; i < body.value_or(none).last; ++i) {
    if (!gives(lines[i], name)) continue;
    lines[i] = changed(lines[i], value);
    return;
  }
  if (!lines.empty() && !lines.back().ends_with('\n')) lines.back() += line_end;
  if (!body) {
    lines.push_back(line_end + '[' + table + ']' + line_end);
    lines.push_back(line);
    return;
  }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(body->last), line);
}

toml::table parsed(std::string_view document) {
  try {
    return toml::parse(document);
  } catch (const toml::parse_error& error) {
    throw Error("the rig file is no TOML: " + std::string(error.description()));
  }
}

}  // namespace

std::string with_values(std::string_view document, const std::vector<NewValue>& values) {
  toml::table wanted = parsed(document);
  std::vector<std::string> lines = lines_of(document);
  for (const NewValue& value : values) {
    const std::size_t dot = value.key.find('.');
    const std::string table = value.key.substr(0, dot);
    set(lines, value);
    if (!wanted.contains(table)) wanted.insert(table, toml::table{});
    wanted[table].as_table()->insert_or_assign(value.key.substr(dot + 1), std::stod(value.value));
  }
  std::string text;
  for (const std::string& line : lines) text += line;
  // Lines are a rough view of TOML: what came out must say what was meant.
  if (parsed(text) != wanted) {
    throw Error("the rig file's layout is not understood: put the values in by hand");
  }
  return text;
}

std::string number_with_sigma(double value, double sigma) {
  const double size = std::abs(value);
  int digits = 6;
  if (sigma > 0.0 && std::isfinite(sigma) && size > 0.0) {
    digits = static_cast<int>(std::ceil(std::log10(size / sigma))) + 2;
  }
  std::string text = fmt::format("{:.{}g}", value, std::clamp(digits, 3, 12));
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace gyrotwin::calibration
