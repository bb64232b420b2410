// From STATE to COMMAND. Pure: it sees neither bus nor clock; services/controller/service.hpp wires
// it to both.
#pragma once

#include <cstdint>

#include "messages/channels.hpp"
#include "services/controller/law.hpp"

namespace gyrotwin {

/// Answers every STATE of the owner it follows with the law's COMMAND.
class Controller {
 public:
  /// @param rig outlives the controller
  /// @param writer random identity of this run of the controller
  /// @throws Error as make_law(), and when the rig's law is `none`
  Controller(const Rig& rig, std::int64_t writer);

  /// Follows the owner that says this: a new epoch takes over here and nowhere else.
  void on_owner(const status_t& status) noexcept;

  /// Fills everything of `command` but header and mac. A STATE heard again gets the same values
  /// again, since the answer may have got lost. @return false where no command is due: another
  /// run's STATE, a mode in which nothing is commanded, tilt or drives that are not known.
  bool answer(const state_t& state, command_t& command) noexcept;

  /// The owner's epoch that is followed; -1: no owner yet.
  std::int64_t owner_epoch() const noexcept { return owner_epoch_; }
  const Law& law() const noexcept { return *law_.law(); }

 private:
  const Rig& rig_;
  model::Machine machine_;
  std::int32_t needed_;  // VALID_* bits
  SampledLaw law_;
  std::int64_t writer_;
  std::int64_t owner_epoch_ = -1;
  std::int64_t answered_sequence_ = -1;  // of owner_epoch_'s STATE; -1: none, the law starts afresh
  std::int64_t counter_ = 0;
  DriveTorques torques_{};
};

}  // namespace gyrotwin
