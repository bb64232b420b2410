// A sweep's folder and its crew: what is written, gone on with, and refused.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "clients/sweep/conduct.hpp"
#include "clients/sweep/results.hpp"
#include "clients/sweep/summary.hpp"
#include "clients/sweep/summary_charts.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeader = "run,a.b,verdict,fell_at_s,largest_tilt_rad\n";

std::string line_of(std::int64_t run) { return std::to_string(run) + ",1,stands,,0.1\n"; }

class SweepFolder : public ::testing::Test {
 protected:
  SweepFolder() : folder_(fs::temp_directory_path() / ("sweep-" + std::to_string(getpid()))) {}
  ~SweepFolder() override { fs::remove_all(folder_); }

  std::string csv() const {
    std::ostringstream text;
    text << std::ifstream(folder_ / "runs.csv").rdbuf();
    return text.str();
  }
  void append(const std::string& text) const {
    std::ofstream(folder_ / "runs.csv", std::ios::app) << text;
  }

  fs::path folder_;
};

TEST_F(SweepFolder, LinesComeInTheOrderOfRuns) {
  Journal journal(folder_, {{"seed", 1}}, kHeader);
  journal.take(2, line_of(2));
  journal.take(1, line_of(1));
  EXPECT_EQ(csv(), kHeader);
  journal.take(0, line_of(0));
  EXPECT_EQ(csv(), kHeader + line_of(0) + line_of(1) + line_of(2));
  EXPECT_EQ(journal.written(), 3);
}

TEST_F(SweepFolder, GoesOnBehindTheLastWholeLine) {
  {
    Journal journal(folder_, {{"seed", 1}}, kHeader);
    for (int run : {0, 1, 3}) journal.take(run, line_of(run));
  }
  append("2,1,sta");  // cut off
  Journal again(folder_, {{"seed", 1}}, kHeader);
  EXPECT_EQ(again.written(), 2);
  again.take(2, line_of(2));
  EXPECT_EQ(csv(), kHeader + line_of(0) + line_of(1) + line_of(2));
}

TEST_F(SweepFolder, RefusesWhatIsNotThisSweep) {
  const auto refused = [&](const nlohmann::json& definition, const std::string& expected) {
    try {
      Journal journal(folder_, definition, kHeader);
      ADD_FAILURE() << expected;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  {
    Journal journal(folder_, {{"seed", 1}}, kHeader);
    refused({{"seed", 1}}, "another sweep is writing");
  }
  refused({{"seed", 2}}, "differs in `seed`");
  append("7,1,stands,,0\n");
  refused({{"seed", 1}}, "the line of run 0 is missing");
  fs::remove(folder_ / "sweep.json");
  refused({{"seed", 1}}, "without sweep.json");
}

/// A definition that was cut off says nothing of which sweep it was.
TEST_F(SweepFolder, RefusesADefinitionThatIsNotWhole) {
  for (const std::string text : {"", "{\n \"seed\": ", "7", "[1]"}) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "sweep.json") << text;
    try {
      Journal journal(folder_, {{"seed", 1}}, kHeader);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("sweep.json cannot be read"), std::string::npos)
          << error.what();
    }
    EXPECT_FALSE(fs::exists(folder_ / "runs.csv")) << text;
  }
}

/// Whatever is there when it is cut off while it begins.
TEST_F(SweepFolder, BeginsAgainWhereItBarelyBegan) {
  const nlohmann::json definition{{"seed", 1}};
  const auto begins = [&](const char* when) {
    Journal journal(folder_, definition, kHeader);
    EXPECT_EQ(journal.written(), 0) << when;
    journal.take(0, line_of(0));
    EXPECT_EQ(csv(), kHeader + line_of(0)) << when;
    std::ifstream stream(folder_ / "sweep.json");
    EXPECT_EQ(nlohmann::json::parse(stream), definition) << when;
  };
  fs::create_directories(folder_);
  begins("the folder alone");
  fs::remove(folder_ / "sweep.json");
  fs::remove(folder_ / "runs.csv");
  std::ofstream(folder_ / "sweep.json.new") << "{\n \"se";
  begins("a draft of the definition");
  fs::remove(folder_ / "runs.csv");
  begins("the definition without runs");
  std::ofstream(folder_ / "runs.csv") << "run,a";
  begins("a header cut off");
}

/// The lock goes with its holder: a child that outlives it for a moment does not keep others out.
TEST_F(SweepFolder, WaitsForAKilledOnesWorkers) {
  int told[2];
  ASSERT_EQ(pipe(told), 0);
  const pid_t holder = fork();
  if (holder == 0) {
    Journal journal(folder_, {{"seed", 1}}, kHeader);
    if (fork() == 0) {  // a worker that has not yet heard of its end
      usleep(200'000);
      _exit(0);
    }
    if (write(told[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(told[0], &byte, 1), 1);
  kill(holder, SIGKILL);
  waitpid(holder, nullptr, 0);
  EXPECT_NO_THROW(Journal(folder_, {{"seed", 1}}, kHeader));
  close(told[0]);
  close(told[1]);
}

TEST_F(SweepFolder, AnyCrewWritesTheSame) {
  std::string expected = kHeader;
  for (int run = 0; run < 500; ++run) expected += line_of(run);
  for (const int workers : {1, 2, 5}) {
    fs::remove_all(folder_);
    Journal journal(folder_, {}, kHeader);
    const auto crew = process_crew(workers, [](std::int64_t run) {
      if (run % 7 == 0) usleep(500);
      return line_of(run);
    });
    EXPECT_TRUE(conduct(*crew, journal, 500, [](std::int64_t) { return true; }));
    EXPECT_EQ(csv(), expected) << workers;
  }
}

TEST_F(SweepFolder, StopsWhenAskedAndLosesNothing) {
  Journal journal(folder_, {}, kHeader);
  const auto crew = process_crew(2, line_of);
  EXPECT_FALSE(conduct(*crew, journal, 500, [](std::int64_t done) { return done < 100; }));
  EXPECT_GE(journal.written(), 100);
  EXPECT_LT(journal.written(), 110);
  EXPECT_TRUE(conduct(*crew, journal, 500, [](std::int64_t) { return true; }));
  EXPECT_EQ(journal.written(), 500);
}

/// A worker that is killed once is replaced; a run that kills every worker ends the sweep, and what
/// was before it is kept.
TEST_F(SweepFolder, OutlivesItsWorkers) {
  const fs::path mark = folder_ / "killed";
  Journal journal(folder_, {}, kHeader);
  const auto crew = process_crew(2, [&](std::int64_t run) {
    if (run == 20 && !fs::exists(mark)) {
      std::ofstream(mark).put('x');
      raise(SIGKILL);
    }
    if (run == 60) raise(SIGSEGV);
    return line_of(run);
  });
  EXPECT_TRUE(conduct(*crew, journal, 50, [](std::int64_t) { return true; }));
  try {
    conduct(*crew, journal, 100, [](std::int64_t) { return true; });
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("run 60 has ended two workers"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(journal.written(), 60);
}

/// Work that throws ends its worker, the one that was hired in its place too, and none beside them.
TEST_F(SweepFolder, OutlivesWorkThatThrows) {
  Journal journal(folder_, {}, kHeader);
  const auto crew = process_crew(3, [](std::int64_t run) {
    if (run == 20) throw std::runtime_error("thrown");
    return line_of(run);
  });
  try {
    conduct(*crew, journal, 60, [](std::int64_t) { return true; });
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("run 20 has ended two workers; the last one ended with "
                        "exit code 1"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(journal.written(), 20);
  for (std::int64_t run = 100; run < 106; ++run) crew->give(run);
  while (crew->pending() > 0) crew->next(std::chrono::milliseconds(100));
}

TEST_F(SweepFolder, ReplacesWorkersThatThrow) {
  const fs::path first = folder_ / "first", second = folder_ / "second";
  Journal journal(folder_, {}, kHeader);
  const auto once = [](const fs::path& mark) {
    if (fs::exists(mark)) return;
    std::ofstream(mark).put('x');
    throw std::runtime_error("thrown");
  };
  const auto crew = process_crew(2, [&](std::int64_t run) {
    if (run == 5) once(first);
    if (run == 9) once(second);  // by then in a worker that replaces one
    return line_of(run);
  });
  EXPECT_TRUE(conduct(*crew, journal, 40, [](std::int64_t) { return true; }));
  EXPECT_EQ(journal.written(), 40);
}

/// A folder beside others, not a path of new ones.
TEST(SweepPlace, IsAFolderBesideOthers) {
  const auto refusal = [](const fs::path& folder) -> std::string {
    try {
      Journal(folder, {}, "run\n");
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  const fs::path home = fs::temp_directory_path() / ("sweep-parents-" + std::to_string(getpid()));
  fs::create_directory(home);
  EXPECT_NE(refusal(home / "not" / "there").find("there is no folder"), std::string::npos);
  EXPECT_FALSE(fs::exists(home / "not"));
  std::ofstream(home / "file") << "text";
  EXPECT_NE(refusal(home / "file").find("is a file, not a folder"), std::string::npos);
  fs::remove_all(home);
}

TEST(SweepResults, SayHowSureTheyAreOfWhatWasDrawn) {
  std::string csv = "run,a.b,verdict,fell_at_s,largest_tilt_rad\n";
  for (int run = 0; run < 10; ++run) {
    csv += std::to_string(run) + ",0." + std::to_string(run) +
           (run < 8 ? ",stands,," : ",falls,1,") + "0.1\n";
  }
  const Results drawn = read_results(csv, {parse_variable("a.b=uniform(0,1)")});
  const SummaryText text{
      "title", "about", "", 0.7, [](std::size_t) { return ""; }, [](std::size_t) { return ""; }};
  EXPECT_EQ(standing_sentence(drawn, text),
            "8 of 10 runs stand: 80 %, with 95 % confidence 49 to 94.3 %");
  const Results listed = read_results(csv, {parse_variable("a.b=0:0.9:10")});
  EXPECT_EQ(standing_sentence(listed, text), "8 of 10 runs stand: 80 %");
}

/// A range about zero: what counts is how far from it.
TEST(SweepResults, KnowTheInfluenceOfASize) {
  std::string csv = "run,start.thx,verdict,fell_at_s,largest_tilt_rad\n";
  for (int run = 0; run <= 10; ++run) {
    const int place = run - 5;
    csv += std::to_string(run) + "," + std::to_string(place) +
           (std::abs(place) < 3 ? ",stands,," : ",falls,1,") + std::to_string(std::abs(place)) +
           "\n";
  }
  const Results results = read_results(csv, {parse_variable("start.thx=-5:5:11")});
  const Influence seen = influence(results.factors[0], results);
  EXPECT_TRUE(seen.by_size);
  EXPECT_DOUBLE_EQ(seen.tilt, 1.0);
  EXPECT_LT(seen.standing, -0.8);
}

/// The page of 40 runs that all stand, with two drawn values that know nothing of each other.
/// @param tilt of a run, from both values
std::string page_of(double (*tilt)(int a, int c)) {
  std::string csv = "run,a.b,c.d,verdict,fell_at_s,largest_tilt_rad\n";
  for (int run = 0; run < 40; ++run) {
    const int other = 17 * run % 40;
    csv += std::to_string(run) + "," + std::to_string(run) + "," + std::to_string(other) +
           ",stands,," + std::to_string(tilt(run, other)) + "\n";
  }
  const Results results =
      read_results(csv, {parse_variable("a.b=uniform(0,40)"), parse_variable("c.d=uniform(0,40)")});
  const SummaryText text{
      "title", "about", "", 0.7, [](std::size_t) { return ""; }, [](std::size_t) { return ""; }};
  return summary_html(results, text);
}

TEST(SweepResults, ClaimNoMoreThanTheRunsTell) {
  const std::string alike = page_of([](int, int) { return 0.2; });
  const std::string chance = page_of([](int a, int c) { return 1e-3 * (7 * (a + 3 * c) % 41); });
  const std::string one = page_of([](int a, int) { return 1e-3 * a; });
  const std::string both = page_of([](int a, int c) { return 1e-3 * (a + c); });
  const auto says = [](const std::string& page, const char* claim) {
    return page.find(claim) != std::string::npos;
  };
  for (const std::string& page : {alike, chance}) {
    EXPECT_FALSE(says(page, "matter most") || says(page, "matters most"));
    EXPECT_TRUE(says(page, "none is seen to matter"));
    EXPECT_TRUE(says(page, "Nothing that was varied is seen to matter"));
  }
  EXPECT_FALSE(says(alike, "+0.00"));
  EXPECT_TRUE(says(one, "The drawn value that matters most, and another"));
  EXPECT_TRUE(says(both, "The two drawn values that matter most"));
  for (const std::string& page : {one, both}) EXPECT_FALSE(says(page, "Nothing that was varied"));
}

TEST(SweepResults, AreReadBackAndCounted) {
  const std::string csv =
      "run,a.b,c.d,verdict,fell_at_s,largest_tilt_rad\n"
      "0,1,x,stands,,0.1\n"
      "1,2,x,falls,0.5,0.8\n"
      "2,2,y,impossible,,\n"
      "3,1,y,growing,,0.2\n"
      "4,2,x,leans,,0.4\n";
  const Results results = read_results(csv, {parse_variable("a.b=1,2"), parse_variable("c.d=x,y")});
  ASSERT_EQ(results.runs(), 5u);
  EXPECT_EQ(results.factors[0].levels(), (std::vector<double>{1, 2}));
  EXPECT_TRUE(results.factors[1].numbers.empty());
  const SummaryText text{"a <rig>",
                         "about",
                         "but mind",
                         0.7,
                         [](std::size_t run) { return "again " + std::to_string(run); },
                         [](std::size_t run) { return "because `x` is " + std::to_string(run); }};
  EXPECT_EQ(standing_sentence(results, text),
            "1 of 4 runs stand: 25 %; 1 not fallen, but still tilting further; 1 leaning on gimbal "
            "stops; 1 more of 5 is no rig: because `x` is 2");
  const std::string page = summary_html(results, text);
  for (const char* part :
       {"a &lt;rig&gt;", "again 1", "again 3", "because <code>x</code> is 2", "25 %", "By c.d",
        "but mind", "<th>which</th><th class='n'>run</th>", "</html>"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page, summary_html(results, text));
}

}  // namespace
}  // namespace gyrotwin
