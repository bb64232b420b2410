// The user's terminal while a full screen is shown, and the signals that end or disturb it.
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>
#include <string_view>

#include "clients/top/screen.hpp"
#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// What the user or the system wants.
enum class Wish : std::uint8_t { kNothing, kEnd, kResize, kSuspend };

/// Signals as something to wait for. Blocks them for this thread as long as it lives, so that no
/// way out of the program leaves a terminal as it must not be left.
class Signals {
 public:
  /// @throws Error when the system refuses
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// Sleeps up to `timeout_ns`, or until a signal comes, or a key of the terminal when `keys`.
  /// @return kEnd for q, SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGPIPE
  Wish wait(std::int64_t timeout_ns, bool keys);

 private:
  Wish read_signal() const;
  Wish read_keys();

  sigset_t before_;
  Descriptor descriptor_;
  bool keys_end_ = false;
};

/// The alternate screen on stdout, keys unechoed; restored at the end of its life.
class Terminal {
 public:
  Terminal();
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Of the window now; 24 x 80 where the terminal does not say.
  static Size size();
  /// Writes all of it. @return false when the terminal is gone
  static bool write(std::string_view bytes);

  /// Gives the terminal back, stops the process as Ctrl-Z does, and takes the terminal again.
  void suspend();

 private:
  void take();
  void give_back();

  std::optional<termios> before_;  ///< of stdin, where it is a terminal
};

}  // namespace gyrotwin
