// The owner of a rig, as a daemon that depends on it hears it.
#pragma once

#include <cstdint>

#include "messages/channels.hpp"
#include "services/runtime/daemon.hpp"

namespace gyrotwin {

class OwnerWatch {
 public:
  /// @param daemon whose log tells what the owner does; outlives the watch
  explicit OwnerWatch(Daemon& daemon) : daemon_(daemon) {}

  /// A STATUS of an owner.
  void hear(const status_t& status, std::int64_t now) noexcept;
  /// Whether it is silent: for half a second, five STATUS messages. Then the log says so once, and
  /// the text of `own` whom to start.
  bool lost(std::int64_t now, status_t& own) noexcept;
  /// The STATUS that was heard last; zeros before the first one.
  const status_t& last() const noexcept { return last_; }

 private:
  Daemon& daemon_;
  status_t last_{};
  status_t other_{};         // of the run heard before: two owners by turns are no news
  std::int64_t heard_ = -1;  // wall time; -1: never
  bool said_lost_ = true;    // nothing to say before an owner was there
};

}  // namespace gyrotwin
