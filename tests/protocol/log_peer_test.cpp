// Logs that liblcm and its tools read and write, unmodified. Needs a multicast route on `lo`: run
// through tests/support/in_namespace.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>

#include "services/runtime/tap.hpp"
#include "tests/support/process.hpp"
#include "tests/support/raw_peer.hpp"
#include "tests/support/small_log.hpp"

namespace gyrotwin {
namespace {

using support::Content;
using support::contents;
using support::Process;
using support::Sample;

std::string url(const BusConfig& config) {
  return "udpm://" + config.group + ":" + std::to_string(config.port) + "?ttl=0";
}

class LogPeer : public testing::Test {
 protected:
  LogPeer() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gyrotwin-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~LogPeer() override { std::filesystem::remove_all(folder_); }

  /// Messages in a file, which may still grow.
  static std::vector<Content> read(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path)) return {};
    Log log(path);
    return contents(log);
  }

  const BusConfig config_ = test_config();
  const Sample sample_ = support::small_log(false);
  std::filesystem::path folder_;
};

TEST_F(LogPeer, LiblcmReadsWhatWeWrite) {
  const std::string path = folder_ / "ours.lcm";
  LogBytes bytes = sample_.bytes;
  LogWriter(path).append(bytes);

  lcm::LogFile file(path, "r");
  ASSERT_TRUE(file.good());
  std::vector<Content> read;
  std::int64_t number = 0;
  while (const lcm::LogEvent* event = file.readNextEvent()) {
    EXPECT_EQ(event->eventnum, number++);
    EXPECT_GE(event->timestamp, 1'700'000'000'000'000);
    if (is_log_channel(event->channel)) continue;
    const auto* data = static_cast<const std::uint8_t*>(event->data);
    read.push_back({event->channel, {data, data + event->datalen}});
  }
  EXPECT_EQ(read, sample_.contents);
}

TEST_F(LogPeer, WeReadWhatLiblcmWrites) {
  const std::string path = folder_ / "theirs.lcm";
  {
    lcm::LogFile file(path, "w");
    ASSERT_TRUE(file.good());
    for (const Content& content : sample_.contents) {
      LogBytes data = content.data;
      lcm::LogEvent event{0, 5, content.channel, static_cast<std::int32_t>(data.size()),
                          data.data()};
      ASSERT_EQ(file.writeEvent(&event), 0);
    }
  }
  Log log(path);
  EXPECT_EQ(contents(log), sample_.contents);
  EXPECT_FALSE(log.damage().any()) << log.damage_text();
}

TEST_F(LogPeer, WeReadWhatLcmLoggerRecords) {
  const std::filesystem::path path = folder_ / "logger.lcm";
  Process logger({"/usr/bin/lcm-logger", "--flush-interval=1", "--lcm-url=" + url(config_), path},
                 folder_ / "logger.txt");
  Bus bus(config_);
  // It listens at some time after its start, and hears us from then on.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (read(path).empty() && std::chrono::steady_clock::now() < end) {
    bus.send_again("WARM/UP", sample_.contents.front().data);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  for (const Content& content : sample_.contents) {
    ASSERT_TRUE(bus.send_again(content.channel, content.data));
  }
  std::vector<Content> heard;
  while (heard.size() < sample_.contents.size() && std::chrono::steady_clock::now() < end) {
    // It writes to the disk when more comes.
    bus.send_again("WARM/UP", sample_.contents.front().data);
    heard = read(path);
    std::erase_if(heard, [](const Content& content) { return content.channel == "WARM/UP"; });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(heard, sample_.contents);
}

TEST_F(LogPeer, LcmLogplayerPlaysWhatWeWrite) {
  const std::filesystem::path path = folder_ / "ours.lcm";
  LogBytes bytes = sample_.bytes;
  LogWriter(path).append(bytes);

  Tap tap(config_, Tap::Keep::kAll);
  Process player({"/usr/bin/lcm-logplayer", "--lcm-url=" + url(config_), path},
                 folder_ / "player.txt");
  std::vector<Content> heard;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (heard.size() < sample_.contents.size() && std::chrono::steady_clock::now() < end) {
    tap.wait(kSecond / 10);
    while (const auto message = tap.receive()) {
      // Long ones of the log's own come as fragments, which no rig hears.
      if (is_log_channel(message->channel) || message->channel == "LCM_SELF_TEST") continue;
      heard.push_back(
          {std::string(message->channel), {message->payload.begin(), message->payload.end()}});
    }
  }
  EXPECT_EQ(heard, sample_.contents) << player.output();
}

}  // namespace
}  // namespace gyrotwin
