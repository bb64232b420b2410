#include "services/hardware/line.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "messages/big_endian.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

struct Rate {
  int baud;
  speed_t code;
};

constexpr std::array kRates{
    Rate{9600, B9600},       Rate{19200, B19200},     Rate{38400, B38400},
    Rate{57600, B57600},     Rate{115200, B115200},   Rate{230400, B230400},
    Rate{460800, B460800},   Rate{500000, B500000},   Rate{576000, B576000},
    Rate{921600, B921600},   Rate{1000000, B1000000}, Rate{1152000, B1152000},
    Rate{1500000, B1500000}, Rate{2000000, B2000000}, Rate{2500000, B2500000},
    Rate{3000000, B3000000}, Rate{3500000, B3500000}, Rate{4000000, B4000000}};

const Rate* rate_of(int baud) {
  const auto rate =
      std::find_if(kRates.begin(), kRates.end(), [baud](const Rate& r) { return r.baud == baud; });
  return rate == kRates.end() ? nullptr : &*rate;
}

/// Raw, no modem lines, reads that return at once. @return 0 or errno
int make_raw(int terminal, int baud) {
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) return errno;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | HUPCL);
  settings.c_cc[VMIN] = 1;  // without bytes a read says EAGAIN; 0 would be what a hang-up says
  settings.c_cc[VTIME] = 0;
  if (baud != 0) {
    const speed_t code = rate_of(baud)->code;
    ::cfsetispeed(&settings, code);
    ::cfsetospeed(&settings, code);
  }
  if (::tcsetattr(terminal, TCSANOW, &settings) != 0) return errno;
  // It succeeds where anything of it could be set.
  if (baud != 0) {
    if (::tcgetattr(terminal, &settings) != 0) return errno;
    if (::cfgetospeed(&settings) != rate_of(baud)->code) return EINVAL;
  }
  ::tcflush(terminal, TCIOFLUSH);
  ::ioctl(terminal, TIOCEXCL);  // no second program on the line, as far as the kernel can tell
  return 0;
}

/// What is there must be a terminal; what is not may still come.
void check_path(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return;
  bool terminal = S_ISCHR(found.st_mode);
  if (terminal) {
    const Descriptor opened(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    terminal = !opened.valid() || ::isatty(opened.get()) == 1;
  }
  if (terminal) return;
  throw Error(
      fmt::format("hardware.device = {} is no terminal; give the tty of the device's line, e.g. "
                  "/dev/serial/by-id/..., /dev/ttyUSB0 or the --link of gyrotwin rig_emulator",
                  path));
}

}  // namespace

Line::Line(std::string path, int baud) : path_(std::move(path)), baud_(baud) {
  if (baud != 0 && rate_of(baud) == nullptr) {
    std::string rates;
    for (const Rate& rate : kRates) rates += fmt::format(" {},", rate.baud);
    throw Error(fmt::format(
        "hardware.baud = {} is no rate of a terminal; there are{} and 0 for a line that has none",
        baud, rates));
  }
  check_path(path_);
  gyrotwin_decoder_init(&decoder_);
}

bool Line::open() noexcept {
  if (is_open()) return true;
  Descriptor terminal(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!terminal.valid()) {
    error_ = errno;
    return false;
  }
  error_ = make_raw(terminal.get(), baud_);
  if (error_ != 0) return false;
  terminal_ = std::move(terminal);
  ++opened_;
  const std::int64_t good = decoder_.good, bad = decoder_.bad;
  gyrotwin_decoder_init(&decoder_);
  decoder_.good = good;
  decoder_.bad = bad;
  read_ = taken_ = 0;
  first_ = waiting_ = gone_ = 0;
  return true;
}

void Line::close() noexcept {
  terminal_ = Descriptor();
  first_ = waiting_ = gone_ = 0;
}

void Line::lose(int error) noexcept {
  close();
  error_ = error;
}

std::uint64_t Line::type_of(std::span<const std::uint8_t> payload) noexcept {
  return big_endian<std::uint64_t>(payload, 0);
}

/// @return whether there are bytes to take
bool Line::refill() noexcept {
  if (!is_open() || burst_ >= kBurst) return false;
  const ssize_t n = ::read(terminal_.get(), incoming_.data(), incoming_.size());
  if (n > 0) {
    read_ = static_cast<std::size_t>(n);
    taken_ = 0;
    burst_ += static_cast<int>(n);
    return true;
  }
  // A terminal whose other end is gone says so by EIO, or by an end of file.
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  lose(n < 0 ? errno : EPIPE);
  return false;
}

std::span<const std::uint8_t> Line::receive() noexcept {
  for (;;) {
    while (taken_ < read_) {
      const std::size_t size = gyrotwin_decoder_take(&decoder_, incoming_[taken_++]);
      if (size >= 8) return {decoder_.bytes, size};
      if (size > 0) reject();
    }
    if (!refill()) {
      burst_ = 0;
      return {};
    }
  }
}

/// The frame at that place among the waiting ones; not one that has begun to go out.
void Line::drop(std::size_t place) noexcept {
  for (std::size_t i = place; i + 1 < waiting_; ++i) {
    outgoing_[(first_ + i) % kFrames] = outgoing_[(first_ + i + 1) % kFrames];
  }
  --waiting_;
  ++dropped_;
}

void Line::drop_commands() noexcept {
  for (std::size_t i = gone_ > 0 ? 1 : 0; i < waiting_;) {
    if (outgoing_[(first_ + i) % kFrames].command) {
      drop(i);
    } else {
      ++i;
    }
  }
}

void Line::queue(std::span<const std::uint8_t> payload, bool command) noexcept {
  if (!is_open()) {
    ++dropped_;
    return;
  }
  if (waiting_ == kFrames) drop(gone_ > 0 ? 1 : 0);
  Frame& frame = outgoing_[(first_ + waiting_) % kFrames];
  frame.command = command;
  frame.size =
      gyrotwin_frame_encode(payload.data(), payload.size(), frame.bytes.data(), frame.bytes.size());
  ++waiting_;
  flush();
}

void Line::flush() noexcept {
  while (waiting_ > 0 && is_open()) {
    const Frame& frame = outgoing_[first_];
    const ssize_t n = ::write(terminal_.get(), frame.bytes.data() + gone_, frame.size - gone_);
    if (n < 0) {
      if (errno != EAGAIN && errno != EINTR) lose(errno);
      return;
    }
    gone_ += static_cast<std::size_t>(n);
    if (gone_ < frame.size) return;
    gone_ = 0;
    first_ = (first_ + 1) % kFrames;
    --waiting_;
  }
}

LineCounters Line::counters() const noexcept {
  return {.received = decoder_.good - rejected_,
          .bad = decoder_.bad + rejected_,
          .dropped = dropped_,
          .opened = opened_};
}

}  // namespace gyrotwin
