// gyrotwin-sweep as a program: the same bytes whoever does the runs, killed and gone on with.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "clients/sweep/results.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;
using support::Process;

using Words = std::vector<std::string>;

class SweepProgram : public ::testing::Test {
 protected:
  SweepProgram() : home_(fs::temp_directory_path() / ("sweeps-" + std::to_string(getpid()))) {
    fs::create_directories(home_);
  }
  ~SweepProgram() override { fs::remove_all(home_); }

  static Words joined(Words first, const Words& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
  }
  Words sweep(const std::string& folder, const Words& question) const {
    return joined({GYROTWIN_BIN "/gyrotwin-sweep", "--output", (home_ / folder).string()},
                  question);
  }
  int run(const Words& words) {
    Process process(words, home_ / "out");
    const int code = process.wait(120.0);
    output_ = process.output();
    return code;
  }
  std::string file(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(home_ / name, std::ios::binary).rdbuf();
    return text.str();
  }
  std::size_t lines(const std::string& folder) const {
    const std::string text = file(folder + "/runs.csv");
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  fs::path home_;
  std::string output_;
};

const Words kQuestion{"--rig",      "double_brennan",
                      "--vary",     "start.thx=-0.6:0.6:5",
                      "--vary",     "gyros.rotor_speed_rad_s=*uniform(0.2,1.1)",
                      "--vary",     "event1.seed=seed()",
                      "--scenario", "gust",
                      "--runs",     "12",
                      "--duration", "2"};

TEST_F(SweepProgram, GivesTheSameBytesWhoeverDoesTheRuns) {
  ASSERT_EQ(run(sweep("one", joined(kQuestion, {"--workers", "1"}))), 0) << output_;
  EXPECT_EQ(lines("one"), 61u);
  EXPECT_GT(file("one/summary.html").size(), 5000u);
  for (const std::string workers : {"2", "3"}) {
    ASSERT_EQ(run(sweep("pool" + workers, joined(kQuestion, {"--workers", workers}))), 0);
  }
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  const Words mpirun{"/usr/bin/env", "mpirun", "--oversubscribe", "--mca", "btl",
                     "self,vader",   "-n"};
  for (const std::string processes : {"2", "4"}) {
    const Words words = joined(joined(mpirun, {processes}), sweep("mpi" + processes, kQuestion));
    ASSERT_EQ(run(words), 0) << output_;
  }
  for (const std::string folder : {"pool2", "pool3", "mpi2", "mpi4"}) {
    for (const std::string name : {"/runs.csv", "/sweep.json", "/summary.html"}) {
      EXPECT_EQ(file(folder + name), file("one" + name)) << folder << name;
    }
  }
}

/// Killed without warning, interrupted, and gone on with.
TEST_F(SweepProgram, GoesOnAfterAKill) {
  const Words question = joined(kQuestion, {"--workers", "2"});
  ASSERT_EQ(run(sweep("whole", question)), 0) << output_;
  for (const auto& [signal, at] : {std::pair{SIGKILL, 4u}, std::pair{SIGINT, 9u}}) {
    Process process(sweep("cut", question), home_ / "out");
    while (process.running() && lines("cut") < at) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ASSERT_TRUE(process.running());
    process.signal(signal);
    EXPECT_EQ(process.wait(), signal == SIGKILL ? 128 + SIGKILL : 1);
    if (signal == SIGINT) {
      EXPECT_NE(process.output().find("the same command goes on"), std::string::npos);
    }
    EXPECT_LT(lines("cut"), 61u);
  }
  ASSERT_EQ(run(sweep("cut", question)), 0) << output_;
  EXPECT_EQ(file("cut/runs.csv"), file("whole/runs.csv"));
  EXPECT_EQ(file("cut/summary.html"), file("whole/summary.html"));
  EXPECT_EQ(run(sweep("cut", joined(question, {"--seed", "5"}))), 2);
  EXPECT_NE(output_.find("differs in `seed`"), std::string::npos) << output_;
}

/// The page's command makes the run that the table has.
TEST_F(SweepProgram, TellsHowToSeeARunAgain) {
  ASSERT_EQ(run(sweep("again", kQuestion)), 0) << output_;
  const std::string page = file("again/summary.html");
  const std::string before = "</td><td>gyrotwin simulate ";
  const std::size_t at = page.find(before);
  ASSERT_NE(at, std::string::npos);
  const std::size_t index = std::stoul(page.substr(page.rfind('>', at) + 1));
  const std::size_t begin = at + before.size();
  std::string arguments = page.substr(begin, page.find('<', begin) - begin);
  for (const std::string quote = "&#39;"; arguments.find(quote) != std::string::npos;) {
    arguments.replace(arguments.find(quote), quote.size(), "'");
  }
  const fs::path csv = home_ / "again.csv";
  ASSERT_EQ(run({"/bin/sh", "-c",
                 GYROTWIN_BIN "/gyrotwin-simulate " + arguments +
                     " --extra --sample 0.002 --output " + csv.string()}),
            0)
      << output_;

  std::vector<Variable> variables{parse_variable(kQuestion[3]), parse_variable(kQuestion[5]),
                                  parse_variable(kQuestion[7])};
  const Results results = read_results(file("again/runs.csv"), variables);
  std::istringstream rows(file("again.csv"));
  std::string row;
  std::getline(rows, row);
  std::istringstream names(row);
  std::size_t column = 0;
  for (std::string name; std::getline(names, name, ',') && name != "tilt_rad";) ++column;
  double largest = 0.0;
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    std::string cell;
    for (std::size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    largest = std::max(largest, std::stod(cell));
  }
  EXPECT_DOUBLE_EQ(largest, results.largest_tilt[index]);
}

TEST_F(SweepProgram, SaysWhatIsWrong) {
  for (const auto& [words, expected] : std::vector<std::pair<Words, std::string>>{
           {{"--vary", "gyros.rotor_sped=1,2"}, "gyros.rotor_sped"},
           {{"--vary", "start.thz=1,2"}, "this machine has no `thz`"},
           {{"--vary", "start.thx=0.1,much"}, "an initial state takes numbers"},
           {{"--vary", "event1.seed=seed()"}, "no events without --scenario"},
           {{"--vary", "event9.seed=1,2", "--scenario", "gust"}, "there are 1 events"},
           {{"--vary", "event1.sed=1,2", "--scenario", "gust"}, "sed"},
           {{"--vary", "controller.law=*2,3"}, "leave out the *"},
           {{"--vary", "structure.mass_kg=-1,-2"}, "structure.mass_kg"},
           {{"--vary", "structure.mass_kg=1:2"}, "LOW:HIGH:N"},
           {{}, "--vary"}}) {
    EXPECT_EQ(run(sweep("wrong", words)), 2) << expected;
    EXPECT_NE(output_.find(expected), std::string::npos) << output_;
    EXPECT_FALSE(fs::exists(home_ / "wrong"));
  }
}

}  // namespace
}  // namespace gyrotwin
