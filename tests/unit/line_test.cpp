// The line to a device over a pseudo terminal: frames, damage, a cable that is pulled, a peer that
// stops reading; and the clock of the device against ours.
#include "services/hardware/line.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "services/hardware/line_clock.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin {
namespace {

/// The device's end.
class Peer {
 public:
  Peer() : terminal_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    ::grantpt(terminal_.get());
    ::unlockpt(terminal_.get());
    path_ = ::ptsname(terminal_.get());
  }
  const std::string& path() const { return path_; }

  template <class Message>
  std::vector<std::uint8_t> frame(Message message) const {
    const auto payload = encoded(message);
    std::vector<std::uint8_t> bytes(GYROTWIN_FRAME_MAX);
    bytes.resize(gyrotwin_frame_encode(payload.data(), payload.size(), bytes.data(), bytes.size()));
    return bytes;
  }
  void write(std::span<const std::uint8_t> bytes) {
    ASSERT_EQ(::write(terminal_.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  std::vector<std::uint8_t> read() {
    std::vector<std::uint8_t> all(1 << 20);
    std::size_t size = 0;
    for (pollfd waited{.fd = terminal_.get(), .events = POLLIN, .revents = 0};
         ::poll(&waited, 1, 50) > 0;) {
      const ssize_t n = ::read(terminal_.get(), all.data() + size, all.size() - size);
      if (n <= 0) break;
      size += static_cast<std::size_t>(n);
    }
    all.resize(size);
    return all;
  }
  void unplug() { terminal_ = Descriptor(); }

 private:
  Descriptor terminal_;
  std::string path_;
};

/// What comes within a moment.
template <class Message>
std::vector<Message> heard(Line& line) {
  std::vector<Message> messages;
  for (pollfd waited{.fd = line.descriptor(), .events = POLLIN, .revents = 0};
       line.is_open() && ::poll(&waited, 1, 50) > 0;) {
    for (auto payload = line.receive(); !payload.empty(); payload = line.receive()) {
      if (Message message; Line::decode(payload, message)) messages.push_back(message);
    }
  }
  return messages;
}

sensors_t sample(std::int64_t tick) {
  auto sample = distinct<sensors_t>();
  sample.header.tick = tick;
  std::memset(sample.mac, 0, sizeof sample.mac);
  return sample;
}

TEST(Line, HearsWhatADeviceSends) {
  Peer peer;
  Line line(peer.path(), 0);
  ASSERT_TRUE(line.open());
  for (int i = 0; i < 10; ++i) peer.write(peer.frame(sample(i)));
  const auto samples = heard<sensors_t>(line);
  ASSERT_EQ(samples.size(), 10u);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(encoded(samples[i]), encoded(sample(i)));
  EXPECT_EQ(line.counters().received, 10);
  EXPECT_EQ(line.counters().bad, 0);
}

TEST(Line, DamageCostsTheDamagedFrameAlone) {
  Peer peer;
  Line line(peer.path(), 0);
  ASSERT_TRUE(line.open());
  std::mt19937 random(5);
  int whole = 0;
  for (int i = 0; i < 60; ++i) {
    auto frame = peer.frame(sample(i));
    if (i % 3 == 0) {
      frame[random() % (frame.size() - 1)] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    } else if (i % 3 == 1) {
      frame.resize(frame.size() / 2);
      frame.push_back(0);
    } else {
      ++whole;
    }
    peer.write(frame);
    const auto samples = heard<sensors_t>(line);
    if (i % 3 != 2) {
      EXPECT_TRUE(samples.empty()) << i;
    } else {
      EXPECT_EQ(samples.size(), 1u) << i;
    }
  }
  EXPECT_EQ(line.counters().received, whole);
  EXPECT_GE(line.counters().bad, 40);
}

TEST(Line, SendsFramesThatAnOrdinaryPeerReads) {
  Peer peer;
  Line line(peer.path(), 0);
  ASSERT_TRUE(line.open());
  auto command = distinct<command_t>();
  line.send(command);
  const auto bytes = peer.read();
  EXPECT_EQ(bytes, peer.frame(command));  // send() has zeroed the signature
  for (const std::uint8_t byte : command.mac) EXPECT_EQ(byte, 0);
}

/// Nobody reads: the oldest whole frames go, what has begun is finished, and nothing blocks.
TEST(Line, APeerThatStopsReadingCostsTheOldestFrames) {
  Peer peer;
  Line line(peer.path(), 0);
  ASSERT_TRUE(line.open());
  constexpr int kSent = 2000;
  for (int i = 0; i < kSent; ++i) {
    beat_t beat{};
    beat.sent_ns = i;
    line.send(beat);
  }
  EXPECT_TRUE(line.pending());
  const std::int64_t dropped = line.counters().dropped;
  EXPECT_GT(dropped, 0);

  gyrotwin_decoder decoder;
  gyrotwin_decoder_init(&decoder);
  std::vector<std::int64_t> counters;
  for (int round = 0; round < 20; ++round) {
    line.flush();
    for (const std::uint8_t byte : peer.read()) {
      if (const std::size_t size = gyrotwin_decoder_take(&decoder, byte)) {
        beat_t beat;
        ASSERT_TRUE(Line::decode({decoder.bytes, size}, beat));
        counters.push_back(beat.sent_ns);
      }
    }
  }
  EXPECT_EQ(decoder.bad, 0);
  EXPECT_TRUE(std::is_sorted(counters.begin(), counters.end()));
  ASSERT_FALSE(counters.empty());
  EXPECT_EQ(counters.back(), kSent - 1);
  EXPECT_EQ(static_cast<std::int64_t>(counters.size()) + dropped, kSent);
}

/// A line that is too slow: of the commands that wait the newest alone goes out, and none after the
/// word to stop.
TEST(Line, OldCommandsDoNotWait) {
  for (const bool stops : {false, true}) {
    Peer peer;
    Line line(peer.path(), 0);
    ASSERT_TRUE(line.open());
    beat_t beat{};
    while (!line.pending()) line.send(beat);  // the terminal takes no more
    for (int i = 0; i < 10; ++i) {
      command_t command{};
      command.counter = i;
      line.send(command);
    }
    if (stops) {
      line.drop_commands();
      line.send(beat);
    }
    gyrotwin_decoder decoder;
    gyrotwin_decoder_init(&decoder);
    std::vector<std::int64_t> commands;
    for (int round = 0; round < 20; ++round) {
      line.flush();
      for (const std::uint8_t byte : peer.read()) {
        command_t command;
        const std::size_t size = gyrotwin_decoder_take(&decoder, byte);
        if (size > 0 && Line::decode({decoder.bytes, size}, command)) {
          commands.push_back(command.counter);
        }
      }
    }
    EXPECT_EQ(commands, stops ? std::vector<std::int64_t>{} : std::vector<std::int64_t>{9});
    EXPECT_EQ(decoder.bad, 0);
  }
}

TEST(Line, APulledCableIsNoticedAndTheLineOpensAgain) {
  std::string path;
  {
    Peer peer;
    path = peer.path();
    Line line(path, 0);
    ASSERT_TRUE(line.open());
    peer.unplug();
    EXPECT_TRUE(line.receive().empty());
    EXPECT_FALSE(line.is_open());
    EXPECT_NE(line.error(), 0);
    auto command = distinct<command_t>();
    line.send(command);  // nowhere to go
    EXPECT_FALSE(line.open());
    Peer again;  // takes the free number
    if (again.path() == path) {
      EXPECT_TRUE(line.open());
      EXPECT_EQ(line.counters().opened, 2);
    }
  }
}

/// What Line says of a path and a rate; empty: nothing against it.
std::string refusal(const std::string& path, int baud) {
  try {
    const Line line(path, baud);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Line, HasTheRateThatIsAskedFor) {
  for (const auto& [baud, code] :
       {std::pair{9600, B9600}, {115200, B115200}, {3000000, B3000000}}) {
    Peer peer;
    Line line(peer.path(), baud);
    ASSERT_TRUE(line.open());
    termios settings{};
    ASSERT_EQ(::tcgetattr(line.descriptor(), &settings), 0);
    EXPECT_EQ(::cfgetospeed(&settings), code);
    EXPECT_EQ(::cfgetispeed(&settings), code);
  }
}

TEST(Line, SaysWhatRatesThereAre) {
  const std::string said = refusal("/nowhere/tty", 12345);
  for (const char* part : {"hardware.baud = 12345", " 9600, ", " 115200, ", " 4000000"}) {
    EXPECT_NE(said.find(part), std::string::npos) << part << " is not in " << said;
  }
}

/// What is there and no terminal never becomes one; what is not there is a cable that may come.
TEST(Line, IsATerminalOrNotThereYet) {
  EXPECT_EQ(refusal("/nowhere/tty", 115200), "");
  const std::string file = testing::TempDir() + "line_test.txt";
  std::ofstream(file) << "no terminal";
  for (const std::string& path : {file, testing::TempDir(), std::string("/dev/null")}) {
    EXPECT_NE(refusal(path, 0).find("is no terminal"), std::string::npos) << path;
  }
  std::filesystem::remove(file);
}

TEST(Line, DoesNotAllocate) {
  Peer peer;
  Line line(peer.path(), 0);
  ASSERT_TRUE(line.open());
  const auto frame = peer.frame(sample(1));
  command_t command{};
  sensors_t message;
  const AllocationCounter allocations;
  for (int i = 0; i < 20; ++i) {
    line.send(command);
    peer.write(frame);
    for (auto payload = line.receive(); !payload.empty(); payload = line.receive()) {
      Line::decode(payload, message);
    }
  }
  EXPECT_EQ(allocations.count(), 0);
}

/// A device whose clock is off and fast, on a line with jitter that is mostly one way.
TEST(LineClock, FindsOffsetAndDrift) {
  std::mt19937 random(3);
  std::exponential_distribution<double> jitter(1.0 / 200e3);  // [1/ns]
  constexpr double kDrift = 40e-6, kOffset = 5e12;
  const auto device = [&](double host) { return host * (1.0 + kDrift) + kOffset; };
  LineClock clock;
  std::int64_t now = 0;
  for (int i = 0; i < 400; ++i) {
    const double sent = 1e9 + i * 10e6;
    const double heard = sent + 50e3 + jitter(random);
    const double answered = heard + 3e6;
    const double back = answered + 50e3 + jitter(random);
    beat_t beat{};
    beat.echo_ns = std::llround(sent);
    beat.heard_ns = std::llround(device(heard));
    beat.sent_ns = std::llround(device(answered));
    now = std::llround(back);
    clock.on_beat(beat, now);
    clock.on_beat(beat, now + 5);  // the same exchange once more says nothing
  }
  clock.fit(now);
  ASSERT_TRUE(clock.known());
  const double expected = device(static_cast<double>(now)) - static_cast<double>(now);
  EXPECT_NEAR(static_cast<double>(clock.offset_ns()), expected, 3.0 * clock.sigma_ns());
  EXPECT_LT(clock.sigma_ns(), 100'000);
  EXPECT_NEAR(clock.drift_ppm(), 40.0, 15.0);
  const double later = static_cast<double>(now) + 1e8;
  EXPECT_NEAR(static_cast<double>(clock.to_host(std::llround(device(later)))), later, 100e3);
  clock.round_trips().roll();
  EXPECT_GT(clock.round_trips().p50(), 100'000);
}

TEST(LineClock, PassesOverStampsThatCannotBe) {
  LineClock clock;
  for (const auto& [echo, heard, sent] : {std::tuple{0, 5, 6},
                                          {2000, 5, 6},      // of the future
                                          {10, 6, 5},        // answered before heard
                                          {10, 5, 5000}}) {  // longer at the device than away
    beat_t beat{};
    beat.echo_ns = echo;
    beat.heard_ns = heard;
    beat.sent_ns = sent;
    for (int i = 0; i < 20; ++i) clock.on_beat(beat, 1000);
  }
  clock.fit(1000);
  EXPECT_FALSE(clock.known());
}

}  // namespace
}  // namespace gyrotwin
