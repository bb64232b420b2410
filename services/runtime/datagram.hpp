// One datagram: how it is laid out, checked and signed. No socket and no clock, so that tests and a
// fuzzer can drive it. Rules and reasons: messages/README.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "messages/channels.hpp"
#include "services/runtime/key.hpp"

namespace gyrotwin {

/// What a datagram turned out to be; all but kGood name the counter it falls into.
enum class Verdict : std::uint8_t { kGood, kMalformed, kForeign, kOtherRig, kUnauthentic };

/// Datagrams that were not what they should be, since the socket was opened.
struct Refusals {
  std::int64_t malformed = 0;    ///< not a short LCM message, or wrong size or type for its channel
  std::int64_t foreign = 0;      ///< other channels, fragments, LCM self-test
  std::int64_t other_rig = 0;    ///< header.rig_id of somebody else
  std::int64_t unauthentic = 0;  ///< signature missing or wrong

  /// Counts one; kGood is none.
  void count(Verdict verdict) noexcept;
};

/// A datagram taken apart. The rest means something only when the verdict is kGood; name and
/// payload also in a short message on a channel that is not the rig's, which is kForeign.
struct Parsed {
  Verdict verdict;
  Channel channel{};
  std::int64_t epoch = 0;
  std::int64_t sequence = 0;
  std::span<const std::uint8_t> payload{};  ///< fingerprint first, signature last
  std::string_view name{};                  ///< of the channel
};

/// Room for one datagram.
using Frame = std::array<std::uint8_t, kMaxDatagram>;

/// Whether a payload ends with the signature of this channel and what stands before it. Any
/// payload.
bool signed_with(const Key& key, std::string_view channel,
                 std::span<const std::uint8_t> payload) noexcept;

/// LCM's short message as one rig writes it:
/// `LC02` | packet number, 32 bits big endian | channel name | NUL | payload.
class DatagramFormat {
 public:
  /// @throws Error unless `<prefix>/...` is made of `[A-Z0-9_/]` and has at most 63 characters
  DatagramFormat(const std::string& prefix, std::int32_t rig_id, const std::optional<Key>& key);

  /// Judges a datagram. Takes any bytes; those beyond kMaxDatagram + 1 change nothing.
  Parsed parse(std::span<const std::uint8_t> datagram) const noexcept;

  /// Writes all that stands before the payload. @return where the payload begins.
  std::size_t begin(Frame& frame, Channel channel, std::uint32_t packet_number) const noexcept;
  /// The same for any channel, whose name has at most 63 characters.
  static std::size_t begin(Frame& frame, std::string_view channel,
                           std::uint32_t packet_number) noexcept;

  /// Writes the signature into the last 32 of `size` bytes: of all from the channel's name on, or
  /// zeros when there is no key.
  void sign(Frame& frame, std::size_t size) const noexcept;

 private:
  bool authentic(std::span<const std::uint8_t> datagram) const noexcept;

  std::array<std::string, kChannels.size()> names_;
  std::array<std::uint64_t, kChannels.size()> fingerprints_;
  std::int32_t rig_id_;
  std::optional<Key> key_;
};

}  // namespace gyrotwin
