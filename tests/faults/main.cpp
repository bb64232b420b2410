// The fault suite: all rows, or those that --gtest_filter names.
//   faults_test [--table FILE]     writes the table into FILE when every row holds
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "tests/faults/row.hpp"

namespace gyrotwin::faults {

namespace {

constexpr std::string_view kBegin = "<!-- rows: deploy/test --faults writes them -->\n";
constexpr std::string_view kEnd = "<!-- end of rows -->\n";

}  // namespace

Table& table() {
  static Table all;
  return all;
}

void Table::write(const std::filesystem::path& file) const {
  std::ostringstream read;
  read << std::ifstream(file).rdbuf();
  const std::string text = read.str();
  const std::size_t begin = text.find(kBegin), end = text.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos) {
    throw std::runtime_error(file.string() + " has no markers for the rows");
  }
  std::ofstream out(file);
  out << text.substr(0, begin) << kBegin << "\n| fault | what the rig does | ticks | what the "
      << "operator is told | what brings it back |\n|---|---|---|---|---|\n";
  for (const Row& row : rows_) {
    out << "| " << row.fault << " | " << row.does << " | " << row.ticks << " | " << row.told
        << " | " << row.back << " |\n";
  }
  out << '\n' << text.substr(end);
}

}  // namespace gyrotwin::faults

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  if (failed == 0 && argc == 3 && std::string_view(argv[1]) == "--table") {
    gyrotwin::faults::table().write(argv[2]);
    std::printf("written: %s\n", argv[2]);
  }
  return failed;
}
