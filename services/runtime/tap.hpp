// An ear on a rig's bus for who keeps a record: everything that is the rig's, in whatever order it
// comes, and on request what is not the rig's either. Never speaks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "services/runtime/bus.hpp"
#include "services/runtime/datagram.hpp"
#include "services/runtime/multicast.hpp"
#include "services/runtime/sequence_order.hpp"

namespace gyrotwin {

/// One datagram that was heard; name and payload are valid until the next receive().
struct Overheard {
  std::string_view channel;  ///< whole name
  std::int64_t received_us;  ///< when the kernel had it: wall clock, since 1970 [us]
  std::span<const std::uint8_t> payload;
};

/// One socket. Not thread-safe. Neither blocks nor allocates once open.
class Tap {
 public:
  /// What is asked for [bytes, as the kernel counts them: about 1 kB for a STATE].
  static constexpr int kReceiveBuffer = 64 << 20;

  enum class Keep : std::uint8_t { kRig, kAll };

  /// @param keep kAll: also short messages on channels that are no rig channels, undecoded, whose
  ///        name has only visible ASCII characters
  /// @throws Error as a Bus does
  Tap(const BusConfig& config, Keep keep);
  Tap(const Tap&) = delete;
  Tap& operator=(const Tap&) = delete;

  /// Next datagram to be kept: of the rig, well formed and authentic; repeats and what comes late
  /// too. Everything else is dropped and counted. Empty when nothing more waits, or when 256
  /// datagrams were read since the last empty result.
  std::optional<Overheard> receive() noexcept;

  /// Sleeps until a datagram may wait or `timeout_ns` have passed. @return whether one may wait.
  bool wait(std::int64_t timeout_ns) noexcept;

  /// As Bus counts; what is `reordered` was kept all the same. Asks the kernel what it has dropped.
  const BusCounters& counters() noexcept;

  /// Receive buffer that the kernel granted [bytes, as it counts them].
  int granted_buffer() const noexcept { return granted_; }

 private:
  std::optional<std::size_t> read(std::int64_t& received_us) noexcept;
  bool judge(const Parsed& parsed) noexcept;
  void put_in_order(const Parsed& parsed) noexcept;

  DatagramFormat format_;
  MulticastSockets sockets_;
  Keep keep_;
  int granted_ = 0;
  std::vector<std::uint8_t> incoming_;
  int burst_ = 0;  // datagrams read since the last empty result
  std::array<SequenceOrder, kChannels.size()> order_;
  BusCounters counters_;
};

}  // namespace gyrotwin
