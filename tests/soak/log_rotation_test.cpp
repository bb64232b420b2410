// A day of `gyrotwin log record --rotate-s 60 --keep N`, compressed: what the recorder is made of
// gets a day of messages as fast as it takes them.
//   GYROTWIN_SOAK_FILES: how many minutes; a day has 1440
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "clients/log/log.hpp"
#include "clients/log/log_series.hpp"
#include "clients/log/spool.hpp"
#include "clients/log/syncer.hpp"
#include "tests/soak/process_watch.hpp"
#include "tests/support/process.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

using support::Process;
using support::ProcessWatch;

constexpr std::int64_t kMinute = 60'000'000;            // [us]
constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // [us since 1970]
constexpr std::int64_t kPerFile = 1200;                 // messages: 20 a second
constexpr std::int64_t kPerTurn = 70;                   // of the recorder; splits no minute evenly
constexpr std::size_t kKept = 5;
/// What the middle and the last third of a run may differ by: a few pages of the allocator's [KiB].
constexpr long kGrowthKib = 256;

int files_wanted() {
  const char* files = std::getenv("GYROTWIN_SOAK_FILES");
  return files != nullptr ? std::atoi(files) : 100;
}

/// Signed STATE messages, whose sequence numbers count from 0.
class States {
 public:
  /// The next one; it belongs to this until the one after it.
  std::span<const std::uint8_t> next() {
    state_t state{};
    state.header.rig_id = support::kSampleRig;
    state.header.epoch = 7;
    state.header.sequence = state.header.tick = count_++;
    const std::size_t at = format_.begin(frame_, Channel::kState, 0);
    state.encode(frame_.data() + at, 0, static_cast<int>(kWireSize<state_t>));
    format_.sign(frame_, at + kWireSize<state_t>);
    return std::span(frame_).subspan(at, kWireSize<state_t>);
  }

 private:
  DatagramFormat format_{"TEST", support::kSampleRig, support::kSampleKey};
  Frame frame_{};
  std::int64_t count_ = 0;
};

/// Reads the files of a series as they are finished.
class Reader {
 public:
  /// Whole, readable alone, and going on where the last one ended.
  void read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    Log log = support::open({std::istreambuf_iterator<char>(file), {}});
    std::int64_t first_us = -1, last_us = -1;
    while (const auto event = log.next()) {
      if (is_log_channel(event->channel)) continue;
      state_t state{};
      ASSERT_GT(state.decode(event->data.data(), 0, static_cast<int>(event->data.size())), 0);
      ASSERT_EQ(state.header.sequence, messages++) << path;
      if (first_us < 0) first_us = event->time_us;
      ASSERT_GE(event->time_us, last_us) << path;
      last_us = event->time_us;
    }
    ASSERT_FALSE(log.damage().any()) << path << ": " << log.damage_text();
    EXPECT_TRUE(log.catalog().checks_signatures()) << path;
    EXPECT_LT(last_us - first_us, kMinute) << path;
    EXPECT_GT(path.string(), last_path_) << "names are sorted as times are";
    last_path_ = path.string();
    ++files;
  }

  std::int64_t messages = 0;
  int files = 0;

 private:
  std::string last_path_;
};

/// Files in a folder of the test's own.
class LogRotation : public testing::Test {
 protected:
  LogRotation() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~LogRotation() override { std::filesystem::remove_all(folder_); }

  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> all;
    for (const auto& file : std::filesystem::directory_iterator(folder_)) all.push_back(file);
    std::ranges::sort(all);
    return all;
  }

  int descriptors_before_ = support::holding_of(::getpid()).descriptors;
  std::filesystem::path folder_;
};

TEST_F(LogRotation, ADayOfFilesLosesNothingAndStaysWithinItsRoom) {
  const int wanted = files_wanted();
  Reader reader;
  Syncer syncer;
  LogSeries series(
      folder_ / "run.lcm", {.time_us = kMinute, .keep = static_cast<int>(kKept)},
      [](int, std::int64_t time_us) { return support::sample_opening(true, time_us); },
      [&](const LogWriter& file) {
        syncer.sync(file.descriptor());
        reader.read(file.path());
      },
      kBegin);

  Spool spool;
  States states;
  LogBytes events;
  ProcessWatch self("recorder", ::getpid());
  std::size_t most_files = 0;
  for (std::int64_t sent = 0; sent < wanted * kPerFile;) {
    for (const std::int64_t end = std::min(sent + kPerTurn, wanted * kPerFile); sent < end;
         ++sent) {
      ASSERT_TRUE(spool.put({.time_us = kBegin + sent * (kMinute / kPerFile),
                             .channel = "TEST/LIVE/STATE",
                             .data = states.next()}));
    }
    ASSERT_TRUE(spool.take(events, std::chrono::milliseconds(50)));
    ASSERT_NO_FATAL_FAILURE(series.append(events));
    if (sent % (10 * kPerTurn) != 0) continue;
    most_files = std::max(most_files, files().size());
    self.sample();
  }
  syncer.finish();
  ASSERT_NO_FATAL_FAILURE(reader.read(series.file().path()));

  EXPECT_EQ(series.files(), wanted);
  EXPECT_EQ(reader.files, wanted);
  EXPECT_EQ(reader.messages, wanted * kPerFile);
  EXPECT_EQ(most_files, kKept);
  EXPECT_EQ(files().size(), kKept);
  EXPECT_EQ(files().back(), series.file().path());
  // A descriptor is duplicated for as long as the disk needs; by now it has all.
  EXPECT_EQ(support::holding_of(::getpid()).descriptors, descriptors_before_ + 1);
  EXPECT_LE(self.growth_kib(), kGrowthKib);
  std::printf("%d files, %lld messages; memory %ld KiB at first, %ld KiB at last\n", series.files(),
              static_cast<long long>(reader.messages), self.samples().front().anonymous_kib,
              self.last().anonymous_kib);

  for (const auto& file : files()) {
    Process info({std::string(GYROTWIN_BIN) + "/gyrotwin-log", "info", file},
                 folder_.string() + ".txt");
    EXPECT_EQ(info.wait(), 0) << info.output();
    EXPECT_NE(info.output().find("damage: none"), std::string::npos) << info.output();
  }
  std::filesystem::remove(folder_.string() + ".txt");
}

}  // namespace
}  // namespace gyrotwin
