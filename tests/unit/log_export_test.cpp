// Exports: what becomes of names, selections, damage, and of an export that cannot be finished.
// Whether other programs read them: protocol/log_readers_test.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "clients/common/file_text.hpp"
#include "clients/log/export.hpp"
#include "clients/log/export_field.hpp"
#include "clients/log/selection.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/exit_code.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;

constexpr int kStates = 3000;

LogBytes state_payload(int i) {
  state_t state{};
  state.header.rig_id = support::kSampleRig;
  state.header.tick = i;
  LogBytes payload(static_cast<std::size_t>(state.getEncodedSize()));
  state.encode(payload.data(), 0, state.getEncodedSize());
  return payload;
}

class LogExport : public testing::Test {
 protected:
  LogExport() {
    std::string pattern = (fs::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    bytes_ = support::small_log(false).bytes;
    for (int i = 0; i < kStates; ++i) {
      append_event(bytes_,
                   {0, 1'700'000'001'000'000 + 1000 * i, "TEST/LIVE/STATE", state_payload(i)});
    }
    write(bytes_);
  }
  ~LogExport() override { fs::remove_all(folder_); }

  void write(LogBytes bytes) {
    fs::remove(folder_ / "run.lcm");
    LogWriter(folder_ / "run.lcm").append(bytes);
  }

  ExportOptions to(const std::string& out) const {
    return {.file = folder_ / "run.lcm", .out = folder_ / out, .format = "", .selection = {}};
  }

  /// Runs an export that fails. @return what it says
  static std::string failure(const ExportOptions& options) {
    try {
      export_log(options);
    } catch (const std::exception& error) {
      return error.what();
    }
    ADD_FAILURE() << "it did not fail";
    return "";
  }

  /// Names of the files beside the log.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::erase(names, "run.lcm");
    std::ranges::sort(names);
    return names;
  }
  std::vector<std::string> lines(const std::string& file) const {
    std::ifstream stream(folder_ / file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  fs::path folder_;
  LogBytes bytes_;
};

TEST(TableField, HasEveryElementWithItsNameAndUnit) {
  const std::vector<std::string> sources{"struct inner_t { double a; int32_t b[2]; }",
                                         "struct outer_t {\n"
                                         "  inner_t x;         // nothing said\n"
                                         "  double  m[2][2];   // [N m] or [V] as it comes\n"
                                         "  inner_t y[2];\n"
                                         "  byte    word[8];   // [1] ASCII, NUL-padded\n"
                                         "  byte    mac[4];    // [1]\n"
                                         "}"};
  const LcmTypes types(sources);
  std::vector<std::string> names, units;
  for (const TableField& field : table_fields(*types.find("outer_t"))) {
    names.insert(names.end(), field.elements.begin(), field.elements.end());
    units.push_back(field.unit);
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"x.a", "x.b[0]", "x.b[1]", "m[0][0]", "m[0][1]", "m[1][0]",
                                      "m[1][1]", "y[0].a", "y[0].b[0]", "y[0].b[1]", "y[1].a",
                                      "y[1].b[0]", "y[1].b[1]", "word"}));
  EXPECT_EQ(units, (std::vector<std::string>{"", "", "N m or V", "", "", "", "", ""}));
}

TEST(Picker, TakesWhatWasStampedBeforeTheFirst) {
  Picker all({}), later({.channels = {}, .from_s = 0.0});
  const LogEvent first{.number = 0, .time_us = 1000, .channel = "R/LIVE/STATE", .data = {}};
  const LogEvent next{.number = 1, .time_us = 999, .channel = "R/LIVE/SENSORS", .data = {}};
  for (Picker* picker : {&all, &later}) EXPECT_TRUE(picker->takes(first));
  EXPECT_TRUE(all.takes(next));
  EXPECT_FALSE(later.takes(next));
}

TEST_F(LogExport, TakesChannelsTimesAndEveryNth) {
  ExportOptions options = to("out.csv");
  options.selection = {.channels = {"LIVE/STATE"}, .from_s = 0.9995, .to_s = 1.9505};
  options.every = 100;
  ASSERT_EQ(export_log(options), kDone);
  EXPECT_EQ(files(), std::vector<std::string>{"out.LIVE_STATE.csv"});
  const auto rows = lines("out.LIVE_STATE.csv");
  // 951 of them, a millisecond apart.
  ASSERT_EQ(rows.size(), 1U + 10U);
  EXPECT_EQ(std::stod(rows.at(1)), 1.0);
  EXPECT_EQ(std::stod(rows.at(10)), 1.9);
}

TEST_F(LogExport, FormatIsTheEndingUnlessNamed) {
  EXPECT_NE(failure(to("out.txt")).find("none of .csv, .mat, .mcap"), std::string::npos);
  ExportOptions options = to("out.txt");
  options.format = "mcap";
  EXPECT_EQ(export_log(options), kDone);
  EXPECT_TRUE(file_text(folder_ / "out.txt").starts_with("\x89MCAP0\r\n"));
  options = to("out.txt");
  options.format = "csv";
  options.selection.channels = {"REPLY"};
  EXPECT_EQ(export_log(options), kDone);
  EXPECT_TRUE(fs::exists(folder_ / "out.txt.REPLY.csv"));
}

TEST_F(LogExport, ReplacesNothingUnlessForced) {
  for (const std::string out : {"out.mat", "out.mcap", "out.LIVE_STATE.csv"}) {
    std::ofstream(folder_ / out) << "mine";
    ExportOptions options = to(out == "out.LIVE_STATE.csv" ? "out.csv" : out);
    EXPECT_NE(failure(options).find(out + ": exists already"), std::string::npos);
    EXPECT_EQ(file_text(folder_ / out), "mine");
    EXPECT_EQ(files(), std::vector<std::string>{out}) << "nothing else is left";
    options.force = true;
    EXPECT_EQ(export_log(options), kDone);
    EXPECT_NE(file_text(folder_ / out), "mine");
    for (const std::string& name : files()) fs::remove(folder_ / name);
  }
}

TEST_F(LogExport, GivesTheSameBytesEveryTime) {
  for (const std::string out : {"out.mat", "out.mcap", "out.LIVE_STATE.csv"}) {
    ExportOptions options = to(out == "out.LIVE_STATE.csv" ? "out.csv" : out);
    export_log(options);
    const std::string first = file_text(folder_ / out);
    options.force = true;
    export_log(options);
    EXPECT_TRUE(file_text(folder_ / out) == first) << out;
  }
}

TEST_F(LogExport, OfAFullDiskNothingIsLeft) {
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit unlimited{};
  ::getrlimit(RLIMIT_FSIZE, &unlimited);
  for (const std::string out : {"out.csv", "out.mat", "out.mcap"}) {
    ExportOptions options = to(out);
    options.compress = false;
    const rlimit limited{100'000, unlimited.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limited);
    const std::string said = failure(options);
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    EXPECT_NE(said.find("cannot be written whole"), std::string::npos) << said;
    EXPECT_EQ(files(), std::vector<std::string>{}) << out;
  }
}

TEST_F(LogExport, OfAnInterruptedOneNothingIsLeft) {
  sigset_t interrupt;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  ::sigprocmask(SIG_BLOCK, &interrupt, nullptr);
  for (const std::string out : {"out.csv", "out.mat", "out.mcap"}) {
    ::raise(SIGINT);
    EXPECT_EQ(failure(to(out)), "interrupted");
    EXPECT_EQ(files(), std::vector<std::string>{}) << out;
    int signal = 0;
    ::sigwait(&interrupt, &signal);
  }
}

TEST_F(LogExport, GoesAroundDamageAndSaysSo) {
  LogBytes bytes = bytes_;
  // The sync word of the 100th state from the end.
  const std::size_t size = kLogHeader + std::string("TEST/LIVE/STATE").size() + kWireSize<state_t>;
  bytes[bytes.size() - 100 * size] ^= 0xFF;
  write(bytes);
  for (const std::string out : {"out.csv", "out.mat", "out.mcap"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(export_log(to(out)), kDone);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("is damaged: "), std::string::npos) << said;
    EXPECT_NE(said.find("1 messages on FOREIGN, which are of no known type"), std::string::npos)
        << said;
  }
  EXPECT_EQ(lines("out.LIVE_STATE.csv").size(), 1U + 1U + kStates - 1U);
}

TEST_F(LogExport, ChannelsOfOneNameGetTablesOfTheirOwn) {
  LogBytes bytes;
  for (const char* channel : {"A/B", "A_B", "9", "A/B"}) {
    append_event(bytes, {0, 0, channel, state_payload(1)});
  }
  write(bytes);
  EXPECT_EQ(export_log(to("out.csv")), kDone);
  EXPECT_EQ(files(), (std::vector<std::string>{"out.A_B.csv", "out.A_B_2.csv", "out.x9.csv"}));
}

TEST_F(LogExport, NothingToExportIsSaid) {
  ExportOptions options = to("out.mcap");
  options.selection.channels = {"FOREIGN"};
  EXPECT_NE(failure(options).find("of a type that the log or this program knows"),
            std::string::npos);
  options.selection.channels = {"LIVE/NOTHING"};
  EXPECT_NE(failure(options).find("other channels are"), std::string::npos);
  EXPECT_EQ(files(), std::vector<std::string>{});
  EXPECT_THROW(export_log(to("nowhere/out.mat")), Error);
  EXPECT_THROW(export_log(to("nowhere/out.mcap")), Error);
}

}  // namespace
}  // namespace gyrotwin
