// Logs as bytes: written, read, and read when damaged everywhere.
#include "clients/log/log_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "clients/log/log.hpp"
#include "clients/log/log_line.hpp"
#include "clients/log/log_reader.hpp"
#include "clients/log/log_series.hpp"
#include "messages/big_endian.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/distinct.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

using support::Content;
using support::contents;
using support::Sample;
using support::small_log;

/// Every event but those of the log's own, as the log reads them; `damage` gets what is lost.
std::vector<Content> read(const LogBytes& bytes, Damage* damage = nullptr) {
  Log log = support::open(bytes);
  std::vector<Content> read = contents(log);
  if (damage != nullptr) *damage = log.damage();
  return read;
}

/// Whether `part` is `whole` with some left out.
bool is_within(const std::vector<Content>& part, const std::vector<Content>& whole) {
  auto at = whole.begin();
  for (const Content& content : part) {
    at = std::find(at, whole.end(), content);
    if (at == whole.end()) return false;
    ++at;
  }
  return true;
}

TEST(LogFile, IsReadAsItWasWritten) {
  for (const bool is_signed : {true, false}) {
    const Sample sample = small_log(is_signed);
    Damage damage;
    EXPECT_EQ(read(sample.bytes, &damage), sample.contents);
    EXPECT_FALSE(damage.any());
  }
}

TEST(LogFile, IsReadAboutOnce) {
  LogBytes bytes = small_log(true).bytes;
  while (bytes.size() < 8 << 20) {
    for (const Content& content : small_log(true).contents) {
      append_event(bytes, {0, 0, content.channel, content.data});
    }
  }
  auto [read_at, size] = support::source(bytes);
  std::int64_t given = 0;
  Log log({[&, read = read_at](std::int64_t offset, std::span<std::uint8_t> to) {
             given += static_cast<std::int64_t>(to.size());
             return read(offset, to);
           },
           size},
          [](const About&) { return support::kSampleKey; });
  contents(log);
  // Measured: 1.0002 times.
  EXPECT_LE(given, 3 * size);
}

TEST(LogFile, CutAnywhereKeepsEveryWholeEvent) {
  const Sample sample = small_log(true);
  for (std::size_t size = 0; size <= sample.bytes.size(); ++size) {
    const LogBytes cut(sample.bytes.begin(),
                       sample.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const auto whole = std::ranges::upper_bound(sample.ends, size) - sample.ends.begin();
    const std::size_t whole_end = whole == 0 ? 0 : sample.ends[static_cast<std::size_t>(whole - 1)];
    const std::size_t opening = sample.ends.size() - sample.contents.size();
    const std::size_t kept =
        std::max<std::size_t>(static_cast<std::size_t>(whole), opening) - opening;
    Damage damage;
    ASSERT_EQ(read(cut, &damage),
              std::vector(sample.contents.begin(),
                          sample.contents.begin() + static_cast<std::ptrdiff_t>(kept)))
        << size;
    ASSERT_EQ(damage.bytes_lost, static_cast<std::int64_t>(size - whole_end)) << size;
    ASSERT_EQ(damage.events_lost, size == whole_end ? 0 : 1) << size;
  }
}

TEST(LogFile, CutOffAtTheStartKeepsEveryWholeEvent) {
  const Sample sample = small_log(true);
  const std::size_t opening = sample.ends.size() - sample.contents.size();
  for (std::size_t begin = 0; begin <= sample.bytes.size(); ++begin) {
    const LogBytes rest(sample.bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                        sample.bytes.end());
    // The first event that begins at or behind the cut.
    const auto cut = static_cast<std::size_t>(
        begin == 0 ? 0 : std::ranges::lower_bound(sample.ends, begin) - sample.ends.begin() + 1);
    const std::size_t lost = std::max(cut, opening) - opening;
    std::vector<Content> expected;
    if (lost < sample.contents.size()) {
      expected.assign(sample.contents.begin() + static_cast<std::ptrdiff_t>(lost),
                      sample.contents.end());
    }
    ASSERT_EQ(read(rest), expected) << begin;
  }
}

TEST(LogFile, OneByteChangedAnywhereCostsItsOwnEventAtMost) {
  // Each byte once by a bit, once wholly, and once so that lengths grow or shrink by a little.
  constexpr std::uint8_t kChanges[] = {0x01, 0x80, 0xFF};
  for (const bool is_signed : {true, false}) {
    const Sample sample = small_log(is_signed);
    const std::size_t opening = sample.ends.size() - sample.contents.size();
    for (std::size_t at = 0; at < sample.bytes.size(); ++at) {
      for (const std::uint8_t change : kChanges) {
        // The log's own events are long, and the same for signed and unsigned rigs.
        if (at < sample.ends[opening - 1] && !(is_signed && change == 0xFF)) continue;
        LogBytes bytes = sample.bytes;
        bytes[at] ^= change;
        std::vector<Content> others = sample.contents;
        const auto hit = static_cast<std::size_t>(std::ranges::upper_bound(sample.ends, at) -
                                                  sample.ends.begin());
        if (hit >= opening)
          others.erase(others.begin() + static_cast<std::ptrdiff_t>(hit - opening));
        Damage damage;
        const std::vector<Content> kept = read(bytes, &damage);
        ASSERT_TRUE(is_within(others, kept)) << "byte " << at << ", change " << +change;
        ASSERT_LE(kept.size(), sample.contents.size()) << "byte " << at;
        // A lost event is a counted one.
        const bool own_lost = hit < opening && damage.bytes_lost > 0;
        ASSERT_EQ(damage.events_lost, own_lost || kept.size() < sample.contents.size() ? 1 : 0)
            << "byte " << at << ", change " << +change;
      }
    }
  }
}

TEST(LogFile, WhatIsChangedInASignedEventIsNeverKept) {
  const Sample sample = small_log(true);
  for (std::size_t at = 0; at < sample.bytes.size(); ++at) {
    LogBytes bytes = sample.bytes;
    bytes[at] ^= 0x10;
    for (const Content& content : read(bytes)) {
      if (content.data.size() == support::kForeignSize) continue;  // nobody signs it
      ASSERT_NE(std::ranges::find(sample.contents, content), sample.contents.end())
          << "byte " << at;
    }
  }
}

TEST(LogFile, BytesPutInOrTakenOutCostTheEventsTheyAreIn) {
  const Sample sample = small_log(true);
  const std::size_t opening = sample.ends.size() - sample.contents.size();
  const std::size_t first = sample.ends[opening - 1];
  for (std::size_t at = first; at < sample.bytes.size(); ++at) {
    const auto hit =
        static_cast<std::size_t>(std::ranges::upper_bound(sample.ends, at) - sample.ends.begin()) -
        opening;
    std::vector<Content> others = sample.contents;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(hit));
    // What stands behind a foreign event may be its own for all that anybody knows.
    std::erase_if(others, [](const Content& content) { return content.channel == "FOREIGN"; });
    for (const std::size_t count : {1U, 7U, 300U}) {
      LogBytes longer = sample.bytes;
      longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(at), count, 0x5A);
      ASSERT_TRUE(is_within(others, read(longer)))
          << "byte " << at << " of event " << hit << ", " << count;
    }
    LogBytes shorter = sample.bytes;
    shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(at));
    ASSERT_TRUE(is_within(others, read(shorter))) << "byte " << at;
  }
}

TEST(LogFile, EventsTakenOutAreCountedByTheirNumbers) {
  Sample sample = small_log(true);
  const std::size_t opening = sample.ends.size() - sample.contents.size();
  const auto at = [&](std::size_t event) {
    return sample.bytes.begin() + static_cast<std::ptrdiff_t>(sample.ends[opening + event - 1]);
  };
  sample.bytes.erase(at(2), at(5));
  Damage damage;
  EXPECT_EQ(read(sample.bytes, &damage).size(), sample.contents.size() - 3);
  EXPECT_EQ(damage.events_lost, 3);
  EXPECT_EQ(damage.bytes_lost, 0);
}

TEST(LogFile, AnEventWithTheSizeOfAnotherChannelIsDroppedAndCounted) {
  Sample sample = small_log(false);
  const LogBytes payload = distinct_payload(Channel::kCommand, support::kSampleRig);
  append_event(sample.bytes, {.number = static_cast<std::int64_t>(sample.ends.size()),
                              .channel = "TEST/LIVE/STATE",
                              .data = payload});
  Damage damage;
  EXPECT_EQ(read(sample.bytes, &damage), sample.contents);
  EXPECT_EQ(damage.wrong_shape, 1);
  EXPECT_EQ(damage.events_lost, 1);
}

TEST(LogFile, TwoLogsOneBehindTheOtherLoseNothing) {
  const Sample sample = small_log(true);
  LogBytes both = sample.bytes;
  both.insert(both.end(), sample.bytes.begin(), sample.bytes.end());
  Damage damage;
  EXPECT_EQ(read(both, &damage).size(), 2 * sample.contents.size());
  EXPECT_FALSE(damage.any());
}

TEST(LogFile, AKeyMadeAnewSinceDropsNothing) {
  const Sample sample = small_log(true);
  const auto other = [](const About&) { return Key{9, 9, 9}; };
  Log log(support::source(sample.bytes), other);
  EXPECT_EQ(contents(log), sample.contents);
  EXPECT_FALSE(log.catalog().checks_signatures());
}

TEST(LogFile, AnOlderVersionDecodesByTheTypesInTheLog) {
  // Another header, and a field less.
  const std::vector<std::string> sources{
      "package gyrotwin; struct header_t { int32_t rig_id; int64_t epoch; int64_t sequence; }",
      "package gyrotwin; struct reply_t { header_t header; int32_t verb; }"};
  const LcmTypes types(sources);
  const LcmType& type = *types.find("reply_t");
  const About about{.program = "older",
                    .host = "here",
                    .rig = "test",
                    .prefix = "TEST",
                    .rig_id = 3,
                    .key = "",
                    .channels = {{"TEST/REPLY", {"reply_t", type.fingerprint, 32}}}};
  LogBytes bytes = opening_events(about, sources, "", 0);
  LogBytes payload(32);
  put_big_endian(type.fingerprint, payload.data());
  payload[11] = 3;  // rig_id
  payload[31] = 9;  // verb
  append_event(bytes, {.number = 4, .channel = "TEST/REPLY", .data = payload});
  for (std::size_t at = 0, n = 0; n < 4; ++n) {
    put_big_endian(std::uint64_t{n}, bytes.data() + at + 4);
    at += size_in_log(first_event(std::span(bytes).subspan(at)));
  }
  Log log = support::open(bytes);
  std::string line;
  while (const auto event = log.next()) line = json_line(log.catalog(), *event, 0.0);
  EXPECT_EQ(line, R"({"time_us":0,"seconds":0.000000,"channel":"TEST/REPLY","type":"reply_t",)"
                  R"("message":{"header":{"rig_id":3,"epoch":0,"sequence":0},"verb":9}})");
  EXPECT_FALSE(log.damage().any());
}

/// Files in a folder of the test's own.
class LogFolder : public testing::Test {
 protected:
  LogFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~LogFolder() override { std::filesystem::remove_all(folder_); }

  static LogBytes contents_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::filesystem::path folder_;
};

TEST_F(LogFolder, AnExistingFileIsKept) {
  const auto path = folder_ / "run.lcm";
  std::ofstream(path) << "dear";
  EXPECT_THROW(LogWriter{path}, Error);
  EXPECT_EQ(contents_of(path), LogBytes({'d', 'e', 'a', 'r'}));
}

TEST_F(LogFolder, AFullDiskKeepsWholeEvents) {
  ::signal(SIGXFSZ, SIG_IGN);
  const LogBytes data(100, 7);
  LogBytes events;
  for (int i = 0; i < 50; ++i) append_event(events, {.channel = "C", .data = data});
  const std::size_t size = events.size() / 50;
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{.rlim_cur = 10 * size + size / 2, .rlim_max = before.rlim_max};
  LogWriter writer(folder_ / "run.lcm");
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(writer.append(events), NotDone);
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(writer.events(), 10);
  EXPECT_EQ(contents_of(folder_ / "run.lcm").size(), 10 * size);
}

TEST_F(LogFolder, ASeriesBySizeLosesNothingAndEachFileIsReadableAlone) {
  const Sample sample = small_log(true);
  const std::size_t opening_size = sample.ends[sample.ends.size() - sample.contents.size() - 1];
  LogBytes events(sample.bytes.begin() + static_cast<std::ptrdiff_t>(opening_size),
                  sample.bytes.end());
  int finished = 0;
  LogSeries series(
      folder_ / "run.lcm", {.bytes = static_cast<std::int64_t>(opening_size + 1000)},
      [](int, std::int64_t time_us) { return support::sample_opening(true, time_us); },
      [&finished](const LogWriter&) { ++finished; }, 0);
  series.append(events);
  series.append(events);
  EXPECT_GT(series.files(), 3);
  EXPECT_EQ(finished, series.files() - 1);
  EXPECT_EQ(series.events(), static_cast<std::int64_t>(2 * sample.contents.size()));

  std::vector<Content> all;
  for (int part = 1; part <= series.files(); ++part) {
    const auto path = numbered(folder_ / "run.lcm", part);
    EXPECT_LE(std::filesystem::file_size(path), opening_size + 1500) << "one event may be larger";
    Log log = support::open(contents_of(path));
    const std::vector<Content> some = contents(log);
    EXPECT_FALSE(log.damage().any()) << log.damage_text();
    EXPECT_TRUE(log.catalog().checks_signatures());
    EXPECT_FALSE(some.empty());
    all.insert(all.end(), some.begin(), some.end());
  }
  std::vector<Content> expected = sample.contents;
  expected.insert(expected.end(), sample.contents.begin(), sample.contents.end());
  EXPECT_EQ(all, expected);
}

TEST_F(LogFolder, ASeriesByTimeBeginsAFileWithTheFirstEventThatIsLate) {
  const LogBytes data(8, 1);
  LogBytes events;
  for (const std::int64_t time_us : {10, 90, 100, 199, 200, 450}) {
    append_event(events, {.time_us = time_us, .channel = "C", .data = data});
  }
  LogSeries series(
      folder_ / "run.lcm", {.time_us = 100}, [](int, std::int64_t) { return LogBytes(); },
      [](const LogWriter&) {}, 0);
  series.append(events);
  EXPECT_EQ(series.files(), 4);
  EXPECT_EQ(contents_of(folder_ / "run.000002.lcm").size(), 2 * (kLogHeader + 1 + 8));
}

TEST_F(LogFolder, ASeriesByTimeGoesOnWhenTheClockIsSetBack) {
  const LogBytes data(8, 1);
  LogBytes events;
  for (const std::int64_t time_us : {5000, 5050, 4990, 1000, 1050, 1100}) {
    append_event(events, {.time_us = time_us, .channel = "C", .data = data});
  }
  LogSeries series(
      folder_ / "run.lcm", {.time_us = 100}, [](int, std::int64_t) { return LogBytes(); },
      [](const LogWriter&) {}, 5000);
  series.append(events);
  EXPECT_EQ(series.files(), 3);
}

/// So many events, each of which fills a file of `keeping()`.
LogBytes full_files(int count) {
  const LogBytes data(8, 1);
  LogBytes events;
  for (int i = 0; i < count; ++i) {
    append_event(events, {.time_us = 100 * i, .channel = "C", .data = data});
  }
  return events;
}

LogSeries keeping(const std::filesystem::path& path, int keep) {
  return {path,
          {.time_us = 100, .keep = keep},
          [](int, std::int64_t) { return LogBytes(); },
          [](const LogWriter&) {},
          0};
}

TEST_F(LogFolder, ASeriesKeepsItsLastFilesAndAllThatIsNotItsOwn) {
  const std::vector<std::string> others{"run.lcm", "run.000001.txt", "run.old.000001.lcm",
                                        "other.000001.lcm", "run.000001x.lcm"};
  for (const std::string& other : others) std::ofstream(folder_ / other) << "dear";
  LogSeries series = keeping(folder_ / "run.lcm", 3);
  LogBytes events = full_files(7);
  series.append(events);
  EXPECT_EQ(series.files(), 7);
  EXPECT_EQ(series.removed(), 4);
  EXPECT_EQ(series.events(), 7);
  std::vector<std::string> expected = others, left;
  for (const int part : {5, 6, 7}) {
    expected.push_back(numbered("run.lcm", part).string());
  }
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    left.push_back(file.path().filename().string());
  }
  std::ranges::sort(expected);
  std::ranges::sort(left);
  EXPECT_EQ(left, expected);
}

TEST_F(LogFolder, WhatCannotBeRemovedIsToldAndTriedAgain) {
  LogSeries series = keeping(folder_ / "run.lcm", 2);
  LogBytes events = full_files(2);
  series.append(events);
  EXPECT_FALSE(series.removal_error());
  // Not even root removes a folder that has something in it.
  const auto first = numbered(folder_ / "run.lcm", 1);
  std::filesystem::rename(first, folder_ / "moved");
  std::filesystem::create_directories(first / "full");
  events = full_files(4);
  series.append(std::span(events).last(events.size() / 2));
  EXPECT_TRUE(series.removal_error());
  EXPECT_EQ(series.removed(), 0);
  EXPECT_EQ(series.files(), 4);

  std::filesystem::remove_all(first);
  events = full_files(5);
  series.append(std::span(events).last(events.size() / 5));
  EXPECT_FALSE(series.removal_error());
  EXPECT_EQ(series.removed(), 3);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "moved"));
}

TEST_F(LogFolder, ASeriesThatWouldMeetAnEarlierOneIsNotBegun) {
  std::ofstream(numbered(folder_ / "run.lcm", 900)) << "dear";
  EXPECT_THROW(keeping(folder_ / "run.lcm", 2), Error);
  EXPECT_THROW(keeping(folder_ / "run.lcm", 0), Error);
  EXPECT_FALSE(std::filesystem::exists(numbered(folder_ / "run.lcm", 1)));
  EXPECT_NO_THROW(keeping(folder_ / "runs.lcm", 2));
  EXPECT_NO_THROW(LogWriter(folder_ / "run.lcm"));
}

// All texts are read anew for each that is new: a log must not make that endless.
TEST(LogCatalog, KnowsSoManyTypesAndNoMore) {
  std::vector<std::string> sources;
  for (int i = 0; i < 300; ++i) {
    sources.push_back("struct t" + std::to_string(i) + "_t { int8_t x" + std::to_string(i) + "; }");
  }
  const LogBytes bytes = opening_events({}, sources, "", 0);
  Catalog catalog([](const About&) { return std::nullopt; });
  std::size_t taken = 0, refused = 0;
  for (std::span<const std::uint8_t> rest(bytes); !rest.empty();) {
    const LogEvent event = first_event(rest);
    if (event.channel == "gyrotwin/log/type") (catalog.take(event) ? taken : refused) += 1;
    rest = rest.subspan(size_in_log(event));
  }
  EXPECT_EQ(taken, 256 - lcm_sources().size());
  EXPECT_EQ(refused, sources.size() - taken);
}

}  // namespace
}  // namespace gyrotwin
