// The only code that knows the wire: LCM's short messages over UDP multicast, signed, on a socket
// of our own. Rules and reasons: messages/README.md.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "messages/channels.hpp"
#include "services/runtime/datagram.hpp"
#include "services/runtime/inbox.hpp"
#include "services/runtime/key.hpp"
#include "services/runtime/multicast.hpp"
#include "services/runtime/sequence_order.hpp"

namespace gyrotwin {

/// What a bus needs to open.
struct BusConfig {
  std::string prefix;       ///< `<RIG>` of every channel name
  std::int32_t rig_id = 0;  ///< header.rig_id
  std::int32_t source = 0;  ///< header.source of what is sent
  std::string group;        ///< IPv4 multicast group
  int port = 0;             ///< UDP port
  std::string interface;    ///< name of the network interface
  int ttl = 0;              ///< multicast TTL
  std::optional<Key> key;   ///< signs and checks every message; absent: neither
};

/// Counts since the bus was opened; per channel by the channel's number.
struct BusCounters : Refusals {
  std::int64_t kernel_dropped = 0;  ///< the socket's buffer was full
  std::int64_t send_failed = 0;     ///< the kernel took no datagram
  std::array<std::int64_t, kChannelSlots> sent{}, received{}, gaps{}, repeats{}, reordered{};
};

/// Datagrams that a socket is read in one go, so that a flood cannot hold its reader.
inline constexpr int kLongestBurst = 256;

/// The sockets, once the configuration holds together.
/// @throws Error naming what is missing (interface, permission, buffer) and the fix
MulticastSockets open_sockets(const BusConfig& config, int receive_buffer);

/// One accepted datagram; its payload is valid until the next receive() or wait().
struct Reception {
  Channel channel;
  bool repeat;  ///< same epoch and sequence as the newest one on this channel
  std::span<const std::uint8_t> payload;  ///< fingerprint first, of the channel's exact size
};

/// Where a message belongs; the rest of its header is the bus's to fill.
struct Stamp {
  std::int64_t epoch = 0;
  std::int64_t sequence = 0;
  std::int64_t tick = 0;
  std::int64_t sim_time_ns = 0;
};

/// One socket to hear, one to speak. Not thread-safe. Never allocates once open, and blocks only
/// where it is given a timeout.
class Bus {
 public:
  /// What a bus asks for [bytes, as the kernel counts them: about 1 kB for a STATE, 2.3 kB for a
  /// STATUS]: a daemon that is held up for 50 ms loses nothing.
  static constexpr int kReceiveBuffer = 4 << 20;

  /// Opens and proves the sockets.
  /// @throws Error naming what is missing (interface, permission, buffer) and the fix
  explicit Bus(const BusConfig& config);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Next datagram that is well formed, of this rig, authentic and not older than the newest of its
  /// sender; what is not is dropped and counted. Empty when nothing more waits, or when 256
  /// datagrams were read since the last empty result, so that a flood cannot hold the caller.
  std::optional<Reception> receive() noexcept;

  /// The next such datagram of up to 256, but sleeps first until one comes or `timeout_ns` have
  /// passed; empty too when all that came was dropped. Where 20 ms and more are left this is one
  /// system call a datagram; who wants all that waits, by receive(), makes one more.
  std::optional<Reception> receive(std::int64_t timeout_ns) noexcept;

  /// Sleeps until a datagram may wait or `timeout_ns` have passed. @return whether one may wait.
  bool wait(std::int64_t timeout_ns) noexcept;

  /// Fills header and signature of `message` and sends it on `channel`, whose type it must be.
  template <class Message>
  void send(Channel channel, Message& message, const Stamp& stamp) noexcept {
    assert(spec(channel).size == kWireSize<Message>);
    stamp_header(message.header, stamp);
    std::uint8_t* payload = begin_payload(channel);
    message.encode(payload, 0, static_cast<int>(kWireSize<Message>));
    sign_and_send(channel);
    std::memcpy(message.mac, payload + kWireSize<Message> - kMacSize, kMacSize);
  }

  /// Sends a recorded payload as it is, header and signature untouched. @return whether the kernel
  /// took it.
  /// @param channel 1 to 63 characters
  bool send_again(std::string_view channel, std::span<const std::uint8_t> payload) noexcept;

  /// Decodes a reception of the right type; receive() has checked size and fingerprint.
  template <class Message>
  static void decode(const Reception& reception, Message& message) noexcept {
    message = {};
    message.decode(reception.payload.data(), 0, static_cast<int>(reception.payload.size()));
  }

  /// Asks the kernel what it has dropped.
  const BusCounters& counters() noexcept;
  /// To poll after receive() was empty: what it holds wakes nobody. To be left blocking.
  int descriptor() const noexcept { return sockets_.receiver.get(); }

 private:
  void stamp_header(header_t& header, const Stamp& stamp) const noexcept;
  std::uint8_t* begin_payload(Channel channel) noexcept;
  void sign_and_send(Channel channel) noexcept;

  std::optional<Reception> judge(std::span<const std::uint8_t> datagram) noexcept;
  std::optional<Reception> put_in_order(const Parsed& parsed) noexcept;

  DatagramFormat format_;
  MulticastSockets sockets_;
  std::int32_t rig_id_;
  std::int32_t source_;

  Frame outgoing_{};
  std::size_t payload_at_ = 0;
  std::uint32_t packets_ = 0;  // LCM's packet number, which nobody here reads

  Inbox inbox_;
  int burst_ = 0;  // datagrams read since the last empty result
  std::array<SequenceOrder, kChannels.size()> order_;

  BusCounters counters_;
};

}  // namespace gyrotwin
