// What gyrotwin-simulate's command line makes of mounts and falls.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/process.hpp"

namespace gyrotwin {
namespace {

struct Ran {
  int exit_code;
  std::string said;
  std::ptrdiff_t rows;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class Simulate : public testing::Test {
 protected:
  Simulate() {
    std::string name = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Simulate() override { std::filesystem::remove_all(folder_); }

  Ran run(std::vector<std::string> words) const {
    const std::string csv = folder_ / "out.csv";
    words.insert(words.begin(), GYROTWIN_SIMULATE);
    words.insert(words.end(), {"--output", csv});
    support::Process program(words, folder_ / "said");
    const int exit_code = program.wait();
    std::ifstream file(csv);
    const std::ptrdiff_t lines =
        std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\n');
    return {exit_code, program.output(), lines - 1};
  }

  std::filesystem::path folder_;
};

TEST_F(Simulate, AFallBeyondWhereTheEquationsEndIsAnAnswer) {
  const Ran ran = run({"--mount", "universal_joint", "--law", "constant_speed"});
  EXPECT_EQ(ran.exit_code, 0) << ran.said;
  EXPECT_TRUE(contains(ran.said, "falls: ") && contains(ran.said, "end at 90 deg of tilt"))
      << ran.said;
  EXPECT_FALSE(contains(ran.said, "error")) << ran.said;
  EXPECT_GT(ran.rows, 100);  // measured 142
}

TEST_F(Simulate, AFailureWithoutAFallIsAnError) {
  const Ran ran = run({"--motor", "off", "--torque", "1e308", "--duration", "1"});
  EXPECT_EQ(ran.exit_code, 1) << ran.said;
  EXPECT_TRUE(contains(ran.said, "no finite motion")) << ran.said;
}

TEST_F(Simulate, MountCarriesTheInitialStateOver) {
  const Ran ran = run({"--mount", "universal_joint", "--duration", "0.1"});
  EXPECT_EQ(ran.exit_code, 0) << ran.said;
  EXPECT_EQ(ran.rows, 11);
}

TEST_F(Simulate, ASetMountIsReadAsByEveryProgram) {
  const Ran ran = run({"--set", "umbrella.mount=universal_joint", "--duration", "0.1"});
  EXPECT_EQ(ran.exit_code, 2) << ran.said;
  EXPECT_TRUE(contains(ran.said, "initial.q")) << ran.said;
}

}  // namespace
}  // namespace gyrotwin
