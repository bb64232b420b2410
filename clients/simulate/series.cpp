#include "clients/simulate/series.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

double number(std::string_view cell, const std::string& place) {
  const std::string_view digits = cell.starts_with('+') ? cell.substr(1) : cell;
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc() && end == digits.data() + digits.size() && std::isfinite(value)) {
    return value;
  }
  throw Error(place + ": `" + std::string(cell) + "` is no finite number");
}

}  // namespace

Series::Series(std::string_view text, const std::string& source) {
  std::size_t time_column = 0;
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.front() == '#') continue;

    const std::string place = source + ":" + std::to_string(line_number);
    const std::vector<std::string_view> cells = cells_of(line);
    if (columns_.empty()) {
      const auto time = std::find_if(cells.begin(), cells.end(),
                                     [](std::string_view c) { return c == "t_s" || c == "t"; });
      if (time == cells.end() || cells.size() < 2) {
        throw Error(place +
                    ": expected a header such as `t_s,...` that names the time [s] and at "
                    "least one more column, found `" +
                    std::string(line) + "`");
      }
      time_column = static_cast<std::size_t>(time - cells.begin());
      columns_.assign(cells.begin(), cells.end());
      columns_.erase(columns_.begin() + static_cast<std::ptrdiff_t>(time_column));
      values_.assign(columns_.size(), 0.0);
      continue;
    }
    if (cells.size() != columns_.size() + 1) {
      throw Error(place + ": expected " + std::to_string(columns_.size() + 1) +
                  " numbers, as many as the header has names, found " +
                  std::to_string(cells.size()));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      (i == time_column ? times_ : values_).push_back(number(cells[i], place));
    }
    if (times_.size() > 1 && times_.back() <= times_[times_.size() - 2]) {
      throw Error(place + ": time " + std::string(cells[time_column]) +
                  " is not after the one before; sort the rows by time");
    }
  }
  if (times_.empty()) {
    throw Error(source + ": no rows; expected a header such as `t_s,...` and rows of numbers");
  }
}

std::span<const double> Series::at(double t) const noexcept {
  const auto after = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
  return {values_.data() + static_cast<std::size_t>(after) * columns_.size(), columns_.size()};
}

std::string read_file(const std::string& name, const std::string& place) {
  std::ifstream stream(name);
  const std::string why = stream ? "" : std::strerror(errno);
  std::ostringstream text;
  text << stream.rdbuf();
  if (why.empty() && !stream.bad() && !std::filesystem::is_directory(name)) return text.str();
  throw Error(place + ": cannot be read" + (why.empty() ? "" : ": " + why));
}

}  // namespace gyrotwin
