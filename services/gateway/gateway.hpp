// Between a rig's bus and the clients of a socket: pure, without socket, clock or file.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/gateway/client.hpp"
#include "services/gateway/foxglove.hpp"
#include "services/gateway/parameters.hpp"
#include "services/gateway/requests.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/rig.hpp"
#include "services/schema/ros2_message.hpp"

namespace gyrotwin {

/// What comes of the operator's wish to record: what the recording is now.
using RecordWish = std::function<foxglove::Json(bool on)>;

/// Counts since the start.
struct GatewayCounters {
  std::int64_t messages_out = 0;  ///< data messages put in outboxes
  std::int64_t messages_left_out =
      0;                             ///< of these, for clients that read too slowly; of those gone
  std::int64_t client_errors = 0;    ///< messages of clients that could not be understood
  std::int64_t requests = 0;         ///< sent on the bus for clients
  std::int64_t requests_denied = 0;  ///< of who is no operator
};

class Gateway {
 public:
  /// @param rig outlives the gateway
  /// @param rig_text the rig file in effect, as TOML
  /// @param send sends a request on the bus
  Gateway(const Rig& rig, std::string_view rig_text, Requests::Send send, RecordWish record);
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// A client is there; the first messages wait in its outbox. Valid until leave().
  Client& join(Role role);
  void leave(Client& client);

  /// A text or binary message of a client. What cannot be understood is answered, not punished.
  void on_text(Client& client, std::string_view text);
  void on_binary(Client& client, std::span<const std::uint8_t> bytes, std::int64_t now_ns);

  /// A message of the bus.
  /// @param now_ns of a monotonic clock, here and below
  /// @param wall_ns since 1970
  void on_reception(const Reception& reception, std::int64_t now_ns, std::uint64_t wall_ns);
  /// Ten times a second.
  void on_timer(std::int64_t now_ns, std::uint64_t wall_ns);
  /// The recording is something else now.
  void on_recording(const foxglove::Json& recording);

  const std::list<Client>& clients() const { return clients_; }
  const GatewayCounters& counters() const { return counters_; }
  /// Last STATUS on a channel; empty: none was heard lately.
  const std::optional<status_t>& status(Channel channel) const {
    return statuses_[static_cast<std::size_t>(channel)];
  }
  const Rig& rig() const { return rig_; }

 private:
  using Json = foxglove::Json;

  void act(Client& client, const Json& json);
  void subscribe(Client& client, const Json& json);
  void unsubscribe(Client& client, const Json& json);
  void advertise(Client& client, const Json& json);
  void unadvertise(Client& client, const Json& json);
  void get_parameters(Client& client, const Json& json);
  void set_parameters(Client& client, const Json& json);
  void watch_parameters(Client& client, const Json& json, bool watch);
  void request(Client& client, std::string_view json_text, std::int64_t now_ns);
  void complain(Client& client, std::string_view text);
  void tell_operators(foxglove::Level level, const std::string& text);
  void address(request_t& request) const;
  void forget(std::int64_t now_ns);

  const Rig& rig_;
  LcmTypes types_;
  std::vector<Ros2Message> encoders_;  // by channel
  std::string advertisement_, session_;
  Parameters parameters_;
  Requests requests_;
  RecordWish record_;
  std::list<Client> clients_;
  std::array<int, kChannels.size()> subscribers_{};
  std::array<std::optional<status_t>, kChannels.size()> statuses_;
  std::array<std::int64_t, kChannels.size()> status_at_{};  // when heard [ns]
  std::optional<status_t> owner_;                           // the last that was heard
  Channel owner_on_ = Channel::kIntegratorStatus;
  GatewayCounters counters_;
};

}  // namespace gyrotwin
