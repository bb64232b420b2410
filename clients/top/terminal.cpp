#include "clients/top/terminal.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

// Alternate screen, no cursor, no wrapping at the right edge, and back.
constexpr std::string_view kTake = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J";
constexpr std::string_view kGiveBack = "\x1b[0m\x1b[?7h\x1b[?25h\x1b[?1049l";

}  // namespace

Signals::Signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGWINCH, SIGTSTP}) {
    sigaddset(&set, signal);
  }
  ::pthread_sigmask(SIG_BLOCK, &set, &before_);
  descriptor_ = Descriptor(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
  if (!descriptor_.valid()) throw Error("the system gives no signalfd; it needs Linux");
}

Signals::~Signals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

Wish Signals::wait(std::int64_t timeout_ns, bool keys) {
  std::array<pollfd, 2> ready{{{.fd = descriptor_.get(), .events = POLLIN, .revents = 0},
                               {.fd = STDIN_FILENO, .events = POLLIN, .revents = 0}}};
  const nfds_t watched = keys && !keys_end_ ? 2 : 1;
  const std::int64_t limit = std::max<std::int64_t>(timeout_ns, 0);
  const timespec timeout{.tv_sec = limit / 1'000'000'000, .tv_nsec = limit % 1'000'000'000};
  if (::ppoll(ready.data(), watched, &timeout, nullptr) <= 0) return Wish::kNothing;
  if (ready[0].revents != 0) return read_signal();
  return read_keys();
}

Wish Signals::read_signal() const {
  signalfd_siginfo info{};
  if (::read(descriptor_.get(), &info, sizeof info) != sizeof info) return Wish::kNothing;
  if (info.ssi_signo == SIGWINCH) return Wish::kResize;
  return info.ssi_signo == SIGTSTP ? Wish::kSuspend : Wish::kEnd;
}

Wish Signals::read_keys() {
  std::array<char, 64> keys{};
  const ssize_t count = ::read(STDIN_FILENO, keys.data(), keys.size());
  keys_end_ = count <= 0;
  const auto end = keys.begin() + std::max<ssize_t>(count, 0);
  return std::find(keys.begin(), end, 'q') != end ? Wish::kEnd : Wish::kNothing;
}

Terminal::Terminal() { take(); }
Terminal::~Terminal() { give_back(); }

Size Terminal::size() {
  winsize window{};
  const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0;
  if (!known || window.ws_row == 0 || window.ws_col == 0) return {};
  return {window.ws_row, window.ws_col};
}

bool Terminal::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

void Terminal::suspend() {
  give_back();
  ::kill(::getpid(), SIGSTOP);
  take();
}

void Terminal::take() {
  termios settings{};
  if (::tcgetattr(STDIN_FILENO, &settings) == 0) {
    before_ = settings;
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &settings);
  }
  write(kTake);
}

void Terminal::give_back() {
  write(kGiveBack);
  if (before_) ::tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

}  // namespace gyrotwin
