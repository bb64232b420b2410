#include "clients/rig_emulator/terminal.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Error(fmt::format("{}: {}", what, std::strerror(errno)));
}

void make_raw(int terminal, const std::string& path) {
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) fail(path + " is no terminal");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (::tcsetattr(terminal, TCSANOW, &settings) != 0) fail(path);
}

void place_link(const std::filesystem::path& link, const std::string& target) {
  std::error_code error;
  if (std::filesystem::is_symlink(link, error)) std::filesystem::remove(link, error);
  std::filesystem::create_symlink(target, link, error);
  if (error) throw Error(fmt::format("--link {}: {}", link.string(), error.message()));
}

}  // namespace

Terminal::Terminal(Descriptor near, Descriptor far, std::string path, std::filesystem::path link)
    : near_(std::move(near)),
      far_(std::move(far)),
      path_(std::move(path)),
      link_(std::move(link)) {}

Terminal::Terminal(Terminal&& other) noexcept
    : near_(std::move(other.near_)),
      far_(std::move(other.far_)),
      path_(std::move(other.path_)),
      link_(std::exchange(other.link_, {})),
      lost_(other.lost_) {}

Terminal::~Terminal() {
  if (link_.empty()) return;
  std::error_code ignored;
  if (std::filesystem::read_symlink(link_, ignored) == path_) {
    std::filesystem::remove(link_, ignored);
  }
}

Terminal Terminal::pseudo(const std::filesystem::path& link) {
  Descriptor near(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 128> name{};
  if (!near.valid() || ::grantpt(near.get()) != 0 || ::unlockpt(near.get()) != 0 ||
      ::ptsname_r(near.get(), name.data(), name.size()) != 0) {
    fail("no pseudo-terminal");
  }
  Descriptor far(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!far.valid()) fail(name.data());
  make_raw(far.get(), name.data());
  if (!link.empty()) place_link(link, name.data());
  return {std::move(near), std::move(far), name.data(), link};
}

Terminal Terminal::device(const std::filesystem::path& path) {
  Descriptor near(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!near.valid()) fail("--device " + path.string());
  make_raw(near.get(), "--device " + path.string());
  return {std::move(near), Descriptor(), path.string(), {}};
}

std::span<const std::uint8_t> Terminal::read(std::span<std::uint8_t> room) noexcept {
  const ssize_t count = ::read(near_.get(), room.data(), room.size());
  if (count > 0) return room.first(static_cast<std::size_t>(count));
  lost_ = lost_ || count == 0 || (errno != EAGAIN && errno != EINTR);
  return {};
}

std::size_t Terminal::write(std::span<const std::uint8_t> bytes) noexcept {
  const ssize_t count = ::write(near_.get(), bytes.data(), bytes.size());
  if (count >= 0) return static_cast<std::size_t>(count);
  lost_ = lost_ || (errno != EAGAIN && errno != EINTR);
  return 0;
}

void Terminal::share() noexcept {
  if (far_.valid()) ::ioctl(far_.get(), TIOCNXCL);
}

}  // namespace gyrotwin
