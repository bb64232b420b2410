// What one listener has heard of a rig, as it is at one moment: all that the screen, the plain text
// and the JSON show.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "messages/channels.hpp"
#include "services/runtime/bus.hpp"

namespace gyrotwin {

/// What was not heard for so long is not live any more [ns]; STATUS comes ten times a second, STATE
/// at least fifty times, but slow motion.
inline constexpr std::int64_t kSilenceNs = 1'000'000'000;

/// The last message of a kind.
template <class Message>
struct Heard {
  Message message{};
  std::int64_t age_ns = 0;
  bool live() const { return age_ns < kSilenceNs; }
};

/// The daemon that speaks on one STATUS channel; empty when none was ever heard.
using Peer = std::optional<Heard<status_t>>;

/// One channel, as heard here.
struct ChannelTraffic {
  double per_second = 0.0;  ///< messages taken, repeats included, over the last second
  std::int64_t received = 0, gaps = 0, repeats = 0, reordered = 0;  ///< since the start
  std::optional<std::int64_t> age_ns;                               ///< of the last one
};

/// How grave a happening is.
enum class Level : std::uint8_t { kInfo, kGood, kWarning, kBad };

/// Something that changed.
struct Happening {
  std::int64_t number;  ///< from 1
  std::int64_t utc_ns;  ///< since 1970
  Level level;
  std::string who;  ///< "owner", "controller", "reply"
  std::string what;
};

/// A disturbance or fault that acts or is scheduled, as asked for while this program listened.
struct Acting {
  std::int64_t epoch;  ///< run of the owner that it belongs to
  std::int64_t id;
  bool fault;
  std::string what;
  std::int64_t begin;               ///< first tick
  std::optional<std::int64_t> end;  ///< first tick after it; empty: until it is cancelled
};

struct Picture {
  std::int64_t utc_ns = 0;  ///< since 1970
  Peer owner, controller, mirror;
  std::optional<header_t> latest;  ///< the owner's newest, of STATE or STATUS
  std::optional<Heard<state_t>> state;
  std::optional<Heard<truth_t>> truth;
  std::optional<Heard<health_t>> health;  ///< of the twin
  std::optional<Heard<forecast_t>> forecast;
  std::optional<Heard<link_t>> link;  ///< of a real plant to its device
  std::optional<command_t> command;
  std::optional<double> speed;  ///< simulated over wall time, measured over the last second
  std::array<ChannelTraffic, kChannels.size()> channels;
  BusCounters bus;  ///< of this listener
  std::vector<Acting> acting;
  std::deque<Happening> happenings;  ///< the last ones, newest last

  bool owner_live() const { return owner && owner->live(); }
};

}  // namespace gyrotwin
