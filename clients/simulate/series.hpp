// A piecewise constant table over time, read from CSV.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// Each row holds from its time until the next one's; zero before the first, the last one stays.
class Series {
 public:
  /// Reads `t_s` (or `t`) and any other columns, one header line, numbers from then on. Blank lines
  /// and lines that begin with # are skipped.
  /// @param source stands before line and column in messages
  /// @throws Error `source:line: ...` with what was found, what was expected and the fix
  Series(std::string_view text, const std::string& source);

  /// Names of the columns but the time, in the order of the file.
  const std::vector<std::string>& columns() const { return columns_; }
  /// Times of the rows, ascending [s].
  const std::vector<double>& times() const { return times_; }
  /// The row that holds at `t` [s], one number a column.
  std::span<const double> at(double t) const noexcept;

 private:
  std::vector<std::string> columns_;
  std::vector<double> times_;
  std::vector<double> values_;  // row by row, a row of zeros first
};

/// The whole text of a file.
/// @throws Error `place: ...` with the reason
std::string read_file(const std::string& name, const std::string& place);

}  // namespace gyrotwin
