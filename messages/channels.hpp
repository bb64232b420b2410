// The one table of the wire: which channel carries which type. Normative text: README.md beside
// this file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gyrotwin/beat_t.hpp"
#include "gyrotwin/command_t.hpp"
#include "gyrotwin/forecast_t.hpp"
#include "gyrotwin/health_t.hpp"
#include "gyrotwin/link_t.hpp"
#include "gyrotwin/reply_t.hpp"
#include "gyrotwin/request_t.hpp"
#include "gyrotwin/sensors_t.hpp"
#include "gyrotwin/state_t.hpp"
#include "gyrotwin/status_t.hpp"
#include "gyrotwin/truth_t.hpp"

namespace gyrotwin {

/// Channels of one rig. The number is the index of the per-channel counters in status_t.
enum class Channel : std::uint8_t {
  kState = 0,
  kCommand = 1,
  kRequest = 2,
  kReply = 3,
  kTruth = 4,
  kIntegratorStatus = 5,
  kControllerStatus = 6,
  kSensors = 7,
  kHardwareStatus = 8,
  kLink = 9,
  kMirrorStatus = 10,
  kTwinState = 11,
  kHealth = 12,
  kForecast = 13,
  kGatewayStatus = 14,
};

/// STATUS of whoever owns the plant, simulated or real.
constexpr bool is_owner_status(Channel channel) {
  return channel == Channel::kIntegratorStatus || channel == Channel::kHardwareStatus;
}

/// Slots of the per-channel counters in status_t; room for channels to come.
inline constexpr std::size_t kChannelSlots = 16;

/// Bytes of `byte mac[32]`, the last field of every message.
inline constexpr std::size_t kMacSize = 32;

/// Longest channel name, `<RIG>/` included, and longest datagram payload: one Ethernet frame, no IP
/// fragment.
inline constexpr std::size_t kMaxChannelName = 63;
inline constexpr std::size_t kMaxDatagram = 1400;

/// Encoded size [bytes], fingerprint included, of a message type. Locked by tests/protocol.
template <class Message>
inline constexpr std::size_t kWireSize = 0;
template <>
inline constexpr std::size_t kWireSize<state_t> = 304;
template <>
inline constexpr std::size_t kWireSize<command_t> = 160;
template <>
inline constexpr std::size_t kWireSize<request_t> = 448;
template <>
inline constexpr std::size_t kWireSize<reply_t> = 288;
template <>
inline constexpr std::size_t kWireSize<truth_t> = 448;
template <>
inline constexpr std::size_t kWireSize<status_t> = 1088;
template <>
inline constexpr std::size_t kWireSize<sensors_t> = 264;
template <>
inline constexpr std::size_t kWireSize<beat_t> = 176;
template <>
inline constexpr std::size_t kWireSize<link_t> = 320;
template <>
inline constexpr std::size_t kWireSize<health_t> = 572;
template <>
inline constexpr std::size_t kWireSize<forecast_t> = 176;

/// Who asks sends a request again [ns] until it is answered, so often at most: where 30 % of all
/// datagrams are lost each way, one request of 700,000 finds no answer.
inline constexpr std::int64_t kAskAgain = 100'000'000;
inline constexpr int kMostAsks = 20;

/// One row of the table.
struct ChannelSpec {
  Channel channel;
  std::string_view suffix;  ///< the name after `<RIG>/`
  std::string_view type;    ///< LCM type
  std::size_t size;         ///< encoded size [bytes], fingerprint included
};

inline constexpr std::array<ChannelSpec, 15> kChannels{{
    {Channel::kState, "LIVE/STATE", "state_t", kWireSize<state_t>},
    {Channel::kCommand, "LIVE/COMMAND", "command_t", kWireSize<command_t>},
    {Channel::kRequest, "REQUEST", "request_t", kWireSize<request_t>},
    {Channel::kReply, "REPLY", "reply_t", kWireSize<reply_t>},
    {Channel::kTruth, "SIM/TRUTH", "truth_t", kWireSize<truth_t>},
    {Channel::kIntegratorStatus, "INTEGRATOR/STATUS", "status_t", kWireSize<status_t>},
    {Channel::kControllerStatus, "CONTROLLER/STATUS", "status_t", kWireSize<status_t>},
    {Channel::kSensors, "LIVE/SENSORS", "sensors_t", kWireSize<sensors_t>},
    {Channel::kHardwareStatus, "HARDWARE/STATUS", "status_t", kWireSize<status_t>},
    {Channel::kLink, "HARDWARE/LINK", "link_t", kWireSize<link_t>},
    {Channel::kMirrorStatus, "MIRROR/STATUS", "status_t", kWireSize<status_t>},
    {Channel::kTwinState, "TWIN/STATE", "state_t", kWireSize<state_t>},
    {Channel::kHealth, "TWIN/HEALTH", "health_t", kWireSize<health_t>},
    {Channel::kForecast, "TWIN/FORECAST", "forecast_t", kWireSize<forecast_t>},
    {Channel::kGatewayStatus, "GATEWAY/STATUS", "status_t", kWireSize<status_t>},
}};

/// Row of a channel.
constexpr const ChannelSpec& spec(Channel channel) {
  return kChannels[static_cast<std::size_t>(channel)];
}

namespace detail {
constexpr bool table_holds() {
  for (std::size_t i = 0; i < kChannels.size(); ++i) {
    if (static_cast<std::size_t>(kChannels[i].channel) != i) return false;
    // 8 bytes of packet header and the NUL after the name.
    if (8 + kMaxChannelName + 1 + kChannels[i].size > kMaxDatagram) return false;
  }
  return kChannels.size() <= kChannelSlots;
}
static_assert(table_holds(), "channels in order of their index, every message in one datagram");
}  // namespace detail

}  // namespace gyrotwin
