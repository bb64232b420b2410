// An owner's dealings with the others on the bus: claims the rig, answers, notices rivals.
#pragma once

#include <optional>

#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/owner.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

/// Listens for a second whether somebody else owns the rig.
/// @throws NotDone naming the other owner
void claim(const Rig& rig, Bus& bus, Clock& clock, const Daemon& daemon);

class OwnerDesk {
 public:
  /// All references outlive the desk.
  /// @param status channel of the owner's STATUS
  OwnerDesk(Bus& bus, Daemon& daemon, Owner& owner, Channel status);

  /// Has the owner do what a COMMAND or a REQUEST says, and notes who else is there; the rest of
  /// the bus is passed over. A request's answer waits for answer(), so that a change of mode is
  /// said first.
  /// @return whether it was a command that the owner obeys
  bool hear(const Reception& reception, std::int64_t now) noexcept;
  /// The answer to the request that was heard last, where there is one yet; once.
  void answer() noexcept;
  /// An answer that was left for later.
  void answer(reply_t& reply) noexcept;

  /// Adds process and bus counters, and says where another owner is heard or no controller.
  void send_status(status_t& status, std::int64_t now) noexcept;

 private:
  bool hear_command(const Reception& reception, std::int64_t now) noexcept;
  void hear_request(const Reception& reception, std::int64_t now) noexcept;
  void hear_other_owner(const Reception& reception, std::int64_t now) noexcept;

  Bus& bus_;
  Daemon& daemon_;
  Owner& owner_;
  Channel status_channel_;
  Identity identity_;
  std::int64_t controller_heard_ = -1;  // wall time; -1: never
  std::int64_t other_owner_heard_ = -1;
  std::uint8_t conflict_[96] = {};  // with whom
  std::optional<reply_t> answer_;   // due
  std::int64_t status_sequence_ = 0;
  std::int64_t reply_sequence_ = 0;
};

}  // namespace gyrotwin
