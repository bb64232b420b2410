// `gyrotwin rig_emulator` as a process: its terminal, its link, what it writes and how it ends.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "services/runtime/clock.hpp"
#include "services/runtime/descriptor.hpp"
#include "tests/support/line_frames.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kRig = 1;  // rig.id of prototype_b

/// A folder of its own, a running emulator, and the host's end of its line.
class Bench : public testing::Test {
 protected:
  Bench() {
    std::string name = testing::TempDir() + "rig_emulator_XXXXXX";
    home_ = ::mkdtemp(name.data());
  }
  ~Bench() override { fs::remove_all(home_); }

  support::Process start(std::vector<std::string> arguments) {
    std::vector<std::string> words{GYROTWIN_BIN "/gyrotwin-rig_emulator", "--link", link()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return {words, home_ / "output.txt"};
  }
  std::string link() const { return home_ / "rig"; }

  /// Once it is there.
  void open() {
    for (int k = 0; k < 3000 && !line_.valid(); ++k) {
      line_ = Descriptor(::open(link().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
      if (!line_.valid()) ::poll(nullptr, 0, 10);
    }
    ASSERT_TRUE(line_.valid());
  }

  void say(std::int32_t mode) {
    beat_t beat{};
    beat.header.rig_id = kRig;
    beat.header.epoch = 5;
    beat.mode = mode;
    beat.command_timeout_ticks = 10;
    beat.safe_stop = beat_t::ZERO_TORQUE;
    beat.echo_ns = heard_ns_;
    const FrameBytes frame = frame_of(beat);
    ASSERT_EQ(::write(line_.get(), frame.data(), frame.size()), static_cast<ssize_t>(frame.size()));
  }

  /// Reads on until a message of this type holds.
  template <class Message, class Holds>
  bool comes(Holds&& holds) {
    // Half a minute of silence, or a minute of something else.
    for (int silent = 0, reads = 0; silent < 300 && reads < 60'000; ++reads) {
      pollfd wait{.fd = line_.get(), .events = POLLIN, .revents = 0};
      if (::poll(&wait, 1, 100) == 0) ++silent;
      std::array<std::uint8_t, 4096> bytes;
      const ssize_t count = ::read(line_.get(), bytes.data(), bytes.size());
      if (count <= 0) continue;
      for (const FrameBytes& payload :
           unframer_.take(std::span(bytes).first(static_cast<std::size_t>(count)))) {
        if (beat_t beat; decode(payload, beat)) heard_ns_ = beat.sent_ns;
        Message message;
        if (decode(payload, message) && holds(message)) return true;
      }
    }
    return false;
  }

  fs::path home_;
  Descriptor line_;
  std::int64_t heard_ns_ = 0;  // sent_ns of the device's newest beat
  Unframer unframer_;
};

TEST_F(Bench, SpeaksOnATerminalThatGoesWithIt) {
  const fs::path truth = home_ / "truth.csv";
  support::Process emulator = start({"--truth", truth, "--clock-offset-s", "1000"});
  open();
  const std::int64_t begun = monotonic_ns() / 1'000'000'000;
  ASSERT_TRUE(comes<sensors_t>([&](const sensors_t& s) {
    return s.header.rig_id == kRig && s.header.tick > 100 &&
           s.header.sim_time_ns / 1'000'000'000 >= begun + 990;
  }));
  say(status_t::MODE_HELD);
  ASSERT_TRUE(comes<beat_t>([](const beat_t& b) { return b.frames_received == 1; }));
  say(status_t::MODE_RUNNING);
  // Nobody commands: it runs, and stops by itself.
  EXPECT_TRUE(comes<beat_t>(
      [](const beat_t& b) { return b.mode == status_t::MODE_SAFE_STOP && b.safe_stops == 1; }));

  emulator.signal(SIGTERM);
  EXPECT_EQ(emulator.wait(), 0) << emulator.output();
  EXPECT_FALSE(fs::is_symlink(link()));
  EXPECT_NE(emulator.output().find("SAFE_STOP: no valid command in time"), std::string::npos)
      << emulator.output();

  // Every row is whole, and ticks leave none out.
  std::ifstream rows(truth);
  std::string row;
  ASSERT_TRUE(std::getline(rows, row));
  const auto columns = std::count(row.begin(), row.end(), ',');
  std::int64_t tick = 0;
  while (std::getline(rows, row)) {
    ASSERT_EQ(std::count(row.begin(), row.end(), ','), columns) << row;
    ASSERT_EQ(std::stoll(row), ++tick);
  }
  EXPECT_GT(tick, 100);
}

TEST_F(Bench, TakesTroublesFromStandardInput) {
  const std::string pipe = home_ / "asked";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  support::Process emulator(
      {"/bin/sh", "-c",
       "exec " GYROTWIN_BIN "/gyrotwin-rig_emulator --from-stdin --link " + link() + " < " + pipe},
      home_ / "output.txt");
  std::ofstream asked(pipe);
  open();
  ASSERT_TRUE(comes<sensors_t>([](const sensors_t& s) { return s.estop == 0; }));
  asked << "estop+1\nnonsense\n" << std::flush;
  EXPECT_TRUE(comes<sensors_t>([](const sensors_t& s) { return s.estop == 1; }));
  EXPECT_TRUE(comes<sensors_t>([](const sensors_t& s) { return s.estop == 0; }));
  asked << "restart\n" << std::flush;
  asked.close();
  EXPECT_TRUE(comes<sensors_t>([](const sensors_t& s) { return s.header.tick == 0; }));
  emulator.signal(SIGINT);
  EXPECT_EQ(emulator.wait(), 0);
  EXPECT_NE(emulator.output().find("there is no `nonsense`"), std::string::npos)
      << emulator.output();
}

TEST_F(Bench, IsToldWhatIsWrong) {
  const auto refused = [this](const std::vector<std::string>& arguments) {
    support::Process emulator = start(arguments);
    EXPECT_EQ(emulator.wait(), 2) << emulator.output();
    return emulator.output();
  };
  EXPECT_NE(refused({"--trouble", "silet@1"}).find("`silent`"), std::string::npos);
  EXPECT_NE(refused({"--truth", "/nowhere/truth.csv"}).find("/nowhere/truth.csv"),
            std::string::npos);
  EXPECT_FALSE(fs::is_symlink(link())) << "and nothing is left";
  // What is no link is somebody's.
  std::ofstream(link()) << "mine";
  refused({});
  EXPECT_TRUE(fs::is_regular_file(link()));
}

}  // namespace
}  // namespace gyrotwin
