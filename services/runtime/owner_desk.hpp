// An owner's dealings with the others on the bus: claims the rig, answers, notices rivals.
#pragma once

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

  /// A controller's COMMAND for this run or its STATUS has come.
  void hear_controller(std::int64_t now) noexcept { controller_heard_ = now; }
  bool controller_heard(std::int64_t now) const noexcept;
  /// STATE or STATUS of another owner: own messages never come back.
  void hear_other_owner(const Reception& reception, std::int64_t now) noexcept;

  /// Does what is asked. Its answer goes out by answer(), once a change of mode has been said.
  /// @return whether there is an answer yet
  bool ask(const request_t& request, std::int64_t now, reply_t& reply) noexcept;
  void answer(reply_t& reply) noexcept;

  /// Adds process and bus counters, and says where no controller is heard.
  void send_status(status_t& status, std::int64_t now) noexcept;

 private:
  Bus& bus_;
  Daemon& daemon_;
  Owner& owner_;
  Channel status_channel_;
  Identity identity_;
  std::int64_t controller_heard_ = -1;  // wall time; -1: never
  std::int64_t other_owner_heard_ = -1;
  std::int64_t status_sequence_ = 0;
  std::int64_t reply_sequence_ = 0;
};

}  // namespace gyrotwin
