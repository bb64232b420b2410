// The rows of the table in README.md beside this file: what each fault did, as it was seen.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gyrotwin::faults {

struct Row {
  std::string fault, does, ticks, told, back;
};

/// All rows of this run of the program, in the order in which they were tried.
class Table {
 public:
  void add(Row row) { rows_.push_back(std::move(row)); }
  /// Replaces what stands between the two markers in a file.
  /// @throws std::runtime_error when the file has no markers
  void write(const std::filesystem::path& file) const;

 private:
  std::vector<Row> rows_;
};

Table& table();

}  // namespace gyrotwin::faults
