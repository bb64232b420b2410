// The texts and bytes of the Foxglove protocol, as far as README.md says that it is spoken. Pure.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/gateway/outbox.hpp"

namespace gyrotwin::foxglove {

using Json = nlohmann::ordered_json;

/// Subprotocols that are spoken, the best first; both have the same messages.
inline constexpr std::string_view kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// Of the client's list (header Sec-WebSocket-Protocol) the best; empty when none is spoken.
std::string_view choose_subprotocol(std::string_view offered);

/// A channel that is offered.
struct Advertised {
  std::uint32_t id;
  std::string topic, schema_name, schema;
};

enum class Level : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

std::string server_info(const std::string& name, const std::string& session,
                        const std::vector<std::pair<std::string, std::string>>& metadata);
std::string advertise(std::span<const Advertised> channels);
std::string status(Level level, std::string_view message);
/// @param values of parameters by name
/// @param id of the question that is answered; empty: of none
std::string parameter_values(const Json& values, const std::string& id);

/// A message of a subscription. @param time_ns since 1970
Outgoing message_data(std::uint32_t subscription, std::uint64_t time_ns, SharedBytes body);
/// @param time_ns since 1970
Outgoing time(std::uint64_t time_ns);

/// What a client publishes: its own channel, and bytes.
struct Published {
  std::uint32_t channel;
  std::string_view data;
};
/// Of a binary message; empty when it is none of that kind.
std::optional<Published> published(std::span<const std::uint8_t> bytes);

}  // namespace gyrotwin::foxglove
