// A record once more through a daemon's core: offline, as fast as it goes, the same every time.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "clients/log/log.hpp"
#include "messages/channels.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Takes what is made: channel, payload with fingerprint and unsigned, time of the message it
/// answers [us since 1970].
using Take =
    std::function<void(Channel channel, std::span<const std::uint8_t> payload, std::int64_t us)>;

/// What has come of it.
struct Account {
  std::int64_t heard = 0;  ///< messages of the record that the core took in
  std::int64_t made = 0;
  std::int64_t recorded = 0;       ///< messages of the record that it may be compared with
  std::int64_t compared = 0;       ///< with one of the record
  std::int64_t different = 0;      ///< of these
  std::string first_difference{};  ///< empty: none
  std::int64_t unknown = 0;   ///< recorded, not compared: what was remembered is not in the record
  std::string why_unknown{};  ///< of the first
};

/// Why it says nothing of the record; empty: it does.
std::string in_vain(const Account& account);

/// The rig file that a log carries.
/// @param overrides as of load_rig()
/// @throws Error where it carries none, or a wrong one
Rig rig_of(Log& log, const std::string& name, const std::vector<std::string>& overrides);

/// SENSORS, COMMAND, STATE and the owner's STATUS to the mirror.
/// @throws Error as Mirror
Account rerun_mirror(Log& log, const Rig& rig, const Take& take);

enum class RerunOn : std::uint8_t { kLive, kTwin };
/// STATE and the owner's STATUS to the controller.
/// @param on whose STATE the recorded controller answered
/// @throws Error as Controller
Account rerun_controller(Log& log, const Rig& rig, RerunOn on, const Take& take);

}  // namespace gyrotwin
