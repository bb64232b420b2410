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

TEST_F(Simulate, AScenarioGoesInTicksWithOrWithoutALaw) {
  const Ran ran = run({"--scenario", "lost_link", "--duration", "5"});
  EXPECT_EQ(ran.exit_code, 0) << ran.said;
  EXPECT_TRUE(contains(ran.said, "safe stop at 4.009 s: no valid command for 10 ticks"))
      << ran.said;
  EXPECT_EQ(ran.rows, 501);
  EXPECT_EQ(run({"--scenario", "push_and_gust", "--law", "none", "--duration", "0.1"}).exit_code,
            0);
}

TEST_F(Simulate, WhatAScenarioAsksForMustBePossible) {
  const Ran unheard = run({"--scenario", "failing_sensors"});
  EXPECT_EQ(unheard.exit_code, 2) << unheard.said;
  EXPECT_TRUE(contains(unheard.said, "failing_sensors.toml:4: the law does not hear the sensors"))
      << unheard.said;
  const Ran rail = run({"--rig", "brennan_monorail", "--scenario", "push_and_gust"});
  EXPECT_EQ(rail.exit_code, 2) << rail.said;
  EXPECT_TRUE(contains(rail.said, "push_and_gust.toml:15: refused: ")) << rail.said;
  const Ran continuous = run({"--scenario", "lost_link", "--feedback", "continuous"});
  EXPECT_EQ(continuous.exit_code, 2) << continuous.said;
  EXPECT_TRUE(contains(continuous.said, "they need sampled feedback")) << continuous.said;
}

TEST_F(Simulate, EstimatesHaveColumnsOfTheirOwn) {
  const Ran ran = run({"--set", "loop.state=estimate", "--extra", "--duration", "0.1"});
  EXPECT_EQ(ran.exit_code, 0) << ran.said;
  std::ifstream file(folder_ / "out.csv");
  std::string header;
  std::getline(file, header);
  EXPECT_TRUE(contains(header, ",rotor_0_rad_s,") && contains(header, ",thx_estimate,")) << header;
  const Ran truth = run({"--extra", "--duration", "0.1"});
  std::ifstream plain(folder_ / "out.csv");
  std::getline(plain, header);
  EXPECT_FALSE(contains(header, "estimate")) << header;
}

TEST_F(Simulate, AnEstimateNeedNotKnowTheTiltOfAFreeDisc) {
  const Ran ran = run({"--rig", "prototype_b_sleeping", "--set", "loop.state=estimate"});
  EXPECT_EQ(ran.exit_code, 0) << ran.said;
  EXPECT_TRUE(contains(ran.said, "stands: ")) << ran.said;
}

TEST_F(Simulate, ASetMountIsReadAsByEveryProgram) {
  const Ran ran = run({"--set", "umbrella.mount=universal_joint", "--duration", "0.1"});
  EXPECT_EQ(ran.exit_code, 2) << ran.said;
  EXPECT_TRUE(contains(ran.said, "initial.q")) << ran.said;
}

}  // namespace
}  // namespace gyrotwin
