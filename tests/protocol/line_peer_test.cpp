// The firmware on a pseudo-terminal, with a host that shares no code with it:
// tests/peers/line_peer.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <numbers>
#include <string>

#include "tests/support/fake_board.hpp"
#include "tests/support/process.hpp"

namespace gyrotwin {
namespace {

/// Both ends, the far one kept open, so that nothing is lost before the peer opens it.
class Pty {
 public:
  Pty() : near_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(::grantpt(near_), 0);
    EXPECT_EQ(::unlockpt(near_), 0);
    name_ = ::ptsname(near_);
    far_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY);
    termios settings{};
    EXPECT_EQ(::tcgetattr(far_, &settings), 0);
    ::cfmakeraw(&settings);
    EXPECT_EQ(::tcsetattr(far_, TCSANOW, &settings), 0);
  }
  ~Pty() {
    ::close(near_);
    ::close(far_);
  }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  int near() const { return near_; }
  const std::string& name() const { return name_; }

 private:
  int near_, far_ = -1;
  std::string name_;
};

/// A device whose line is the pseudo-terminal; notes what its drives were commanded.
struct PtyBoard {
  FakeBoard fake{};
  int line;
  std::vector<gyrotwin_drives> commanded{};

  gyrotwin_board functions() {
    gyrotwin_board board = fake.functions();
    board.context = this;
    board.now_ns = [](void* self) { return of(self).fake.now; };
    board.read_sensors = [](void* self, gyrotwin_sensors* read) { *read = of(self).fake.sensors; };
    board.drive = [](void* self, const gyrotwin_drives* drives) {
      auto& noted = of(self).commanded;
      const bool news = noted.empty() || noted.back().value[0] != drives->value[0];
      if (drives->mode == GYROTWIN_DRIVES_TORQUE && drives->value[0] != 0.0 && news) {
        noted.push_back(*drives);
      }
    };
    board.drive_speed = [](void*, int) { return 0.0; };
    board.rotors_powered = [](void* self) { return of(self).fake.rotors; };
    board.power_rotors = [](void* self, bool on) { of(self).fake.rotors = on; };
    board.write = [](void* self, const std::uint8_t* bytes, std::size_t size) {
      const ssize_t written = ::write(of(self).line, bytes, size);
      return written < 0 ? std::size_t{0} : static_cast<std::size_t>(written);
    };
    return board;
  }

  static PtyBoard& of(void* self) { return *static_cast<PtyBoard*>(self); }
};

/// One sample for each frame that comes, good or bad: the peer sets the pace.
void serve(PtyBoard& board, gyrotwin_device& device, support::Process& peer) {
  std::int64_t heard = 0;
  while (peer.running()) {
    pollfd wait{.fd = board.line, .events = POLLIN, .revents = 0};
    if (::poll(&wait, 1, 100) == 0) continue;
    std::array<std::uint8_t, 512> bytes;
    const ssize_t count = ::read(board.line, bytes.data(), bytes.size());
    for (ssize_t i = 0; i < count; ++i) {
      gyrotwin_device_receive(&device, &bytes[static_cast<std::size_t>(i)], 1);
      const std::int64_t frames = device.decoder.good + device.decoder.bad;
      if (frames == heard) continue;
      heard = frames;
      board.fake.now += DeviceBench::kTick;
      board.fake.sensors.gyro_rad_s[2] = static_cast<double>(device.samples) / 1000.0;
      board.fake.sensors.load_cell_n = -static_cast<double>(device.samples);
      gyrotwin_device_sample(&device);
    }
    gyrotwin_device_flush(&device);
  }
}

TEST(LinePeer, ANodeProgramTakesADeviceThroughARun) {
  const Pty pty;
  PtyBoard board{.line = pty.near()};
  const gyrotwin_board functions = board.functions();
  gyrotwin_device device;
  gyrotwin_device_init(&device, &functions, DeviceBench::kRig, DeviceBench::kDevice);

  support::Process peer({"/usr/bin/env", "node", GYROTWIN_LINE_PEER "/peer.mjs", pty.name(),
                         GYROTWIN_SOURCE_DIR "/messages"},
                        testing::TempDir() + "line_peer.txt");
  serve(board, device, peer);
  ASSERT_EQ(peer.wait(), 0) << peer.output();
  SCOPED_TRACE(peer.output());

  ASSERT_EQ(board.commanded.size(), 200u);
  for (std::size_t k = 1; k <= board.commanded.size(); ++k) {
    const gyrotwin_drives& drives = board.commanded[k - 1];
    EXPECT_EQ(drives.value[0], -static_cast<double>(k) / 8.0);
    EXPECT_EQ(drives.value[1], 1.0 / static_cast<double>(k));
    EXPECT_EQ(drives.value[2], std::numbers::pi);
  }
  EXPECT_EQ(device.commands_refused, 1) << "the one that is not finite";
  EXPECT_EQ(device.decoder.bad, 2);
  EXPECT_EQ(device.outbox.dropped, 0);
  EXPECT_EQ(device.mode, GYROTWIN_HELD);
  EXPECT_TRUE(board.fake.rotors);
}

}  // namespace
}  // namespace gyrotwin
