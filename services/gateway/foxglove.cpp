#include "services/gateway/foxglove.hpp"

#include <algorithm>

#include "services/schema/little_endian.hpp"

namespace gyrotwin::foxglove {

namespace {

constexpr std::uint8_t kMessageData = 1, kTime = 2;  // binary, to clients
constexpr std::uint8_t kClientMessageData = 1;       // binary, of clients

std::string text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string_view choose_subprotocol(std::string_view offered) {
  std::string_view best;
  while (!offered.empty()) {
    std::string_view word = offered.substr(0, offered.find(','));
    offered.remove_prefix(std::min(offered.size(), word.size() + 1));
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    const auto* found = std::ranges::find(kSubprotocols, word);
    if (found == std::end(kSubprotocols)) continue;
    if (best.empty() || found < std::ranges::find(kSubprotocols, best)) best = *found;
  }
  return best;
}

std::string server_info(const std::string& name, const std::string& session,
                        const std::vector<std::pair<std::string, std::string>>& metadata) {
  Json json{{"op", "serverInfo"},
            {"name", name},
            {"capabilities", {"clientPublish", "parameters", "parametersSubscribe", "time"}},
            {"supportedEncodings", {"json"}},
            {"metadata", Json::object()},
            {"sessionId", session}};
  for (const auto& [key, value] : metadata) json["metadata"][key] = value;
  return text(json);
}

std::string advertise(std::span<const Advertised> channels) {
  Json list = Json::array();
  for (const Advertised& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.schema_name},
                    {"schema", channel.schema},
                    {"schemaEncoding", "ros2msg"}});
  }
  return text({{"op", "advertise"}, {"channels", list}});
}

std::string status(Level level, std::string_view message) {
  return text({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string parameter_values(const Json& values, const std::string& id) {
  Json list = Json::array();
  for (const auto& [name, value] : values.items()) {
    Json entry{{"name", name}, {"value", value}};
    if (value.is_number()) entry["type"] = "float64";
    if (value.is_array() && std::ranges::all_of(value, &Json::is_number)) {
      entry["type"] = "float64_array";
    }
    list.push_back(std::move(entry));
  }
  Json json{{"op", "parameterValues"}, {"parameters", list}};
  if (!id.empty()) json["id"] = id;
  return text(json);
}

Outgoing message_data(std::uint32_t subscription, std::uint64_t time_ns, SharedBytes body) {
  Outgoing message{
      .head = {kMessageData}, .head_size = 13, .body = std::move(body), .is_data = true};
  put_little_endian(subscription, &message.head[1]);
  put_little_endian(time_ns, &message.head[5]);
  return message;
}

Outgoing time(std::uint64_t time_ns) {
  Outgoing message{.head = {kTime}, .head_size = 9, .is_data = true};
  put_little_endian(time_ns, &message.head[1]);
  return message;
}

std::optional<Published> published(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHead = 5;
  if (bytes.size() < kHead || bytes[0] != kClientMessageData) return {};
  std::uint32_t channel = 0;
  for (std::size_t i = 0; i < 4; ++i) channel |= std::uint32_t{bytes[1 + i]} << 8 * i;
  const auto* data = reinterpret_cast<const char*>(bytes.data() + kHead);
  return Published{channel, {data, bytes.size() - kHead}};
}

}  // namespace gyrotwin::foxglove
