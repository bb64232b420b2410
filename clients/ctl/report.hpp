// What `gyrotwin ctl status` says, as text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "messages/channels.hpp"

namespace gyrotwin {

/// What was heard of a rig.
struct Sighting {
  std::string rig;    ///< its name
  std::string reach;  ///< where was listened: "this host only (lo, ...)"
  std::optional<status_t> owner;
  std::optional<status_t> controller;
  std::optional<command_t> command;           ///< the last one
  std::optional<state_t> state;               ///< the last one
  std::vector<double> nominal_rotor_speed{};  ///< of the rig's rotors [rad/s]
  std::optional<status_t> mirror{};           ///< many rigs have none
  std::optional<link_t> link{};               ///< of a real plant to its device
};

/// Angle between the structure's axis and the vertical [rad], where STATE tells it.
std::optional<double> tilt(const Sighting& sighting);

/// Speed over nominal speed of each rotor, where STATE tells it; empty: it does not.
std::vector<double> rotor_shares(const Sighting& sighting);

/// Who holds the owner's command lease: "nobody", "the controller", "writer ...".
/// @pre sighting.owner
std::string lease_holder(const Sighting& sighting);

/// For people; names the peer that is not heard and how to start it.
std::string report(const Sighting& sighting);

/// For programs: one object; a peer that is not heard is null. Identities are texts, since 63 bits
/// are more than a JSON number holds.
std::string report_json(const Sighting& sighting);

}  // namespace gyrotwin
