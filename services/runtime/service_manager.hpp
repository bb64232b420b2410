// What systemd is told of a daemon: that it is up, how it is, that it lives.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

/// The service manager that has started this process ($NOTIFY_SOCKET), or nobody: then nothing here
/// does anything. Never waits: what a manager has no room for is said again at the next call. Talks
/// through a socket, so not for a tick thread.
class ServiceManager {
 public:
  using Time = std::chrono::steady_clock::time_point;

  ServiceManager();

  /// Somebody wants to know.
  bool listens() const noexcept { return socket_.valid(); }

  /// What the tick thread has come to. With its first round the daemon counts as started. After
  /// that the watchdog ($WATCHDOG_USEC) is fed four times in its time, but only when the tick
  /// thread has gone round since it was last fed.
  void hear_rounds(std::uint64_t rounds, Time now);

  /// How the daemon is, for `systemctl status`; said when it is news, at most once a second.
  void show(std::string_view status, Time now);

  /// The daemon ends.
  void stopping();

 private:
  bool notify(std::string_view message) const;

  Descriptor socket_;
  sockaddr_un address_{};
  socklen_t address_size_ = 0;
  Time::duration feeding_period_{};  // 0: no watchdog
  std::uint64_t rounds_ = 0;         // when last fed
  Time fed_at_{}, shown_at_{};
  std::string shown_;
  bool stopping_ = false;
};

}  // namespace gyrotwin
