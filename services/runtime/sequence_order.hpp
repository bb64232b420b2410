// Where a message stands among those of its channel: messages/README.md, epochs and sequences.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace gyrotwin {

/// a + b, b not negative; a hostile sequence number must not overflow a counter.
constexpr std::int64_t add_saturating(std::int64_t a, std::int64_t b) noexcept {
  return b > std::numeric_limits<std::int64_t>::max() - a ? std::numeric_limits<std::int64_t>::max()
                                                          : a + b;
}

/// Newest sequence of every sender that one channel has heard, the 16 last heard.
class SequenceOrder {
 public:
  enum class Place : std::uint8_t { kNewer, kRepeat, kOlder };
  struct Finding {
    Place place;
    std::int64_t missing;  ///< kNewer: numbers left out since the newest before
  };

  /// @param epoch, sequence of a message, neither negative
  Finding hear(std::int64_t epoch, std::int64_t sequence) noexcept {
    // The sender's entry moves to the front; a new sender takes that of the one not heard for
    // longest.
    const auto known = std::ranges::find(senders_, epoch, &Sender::epoch);
    const bool is_new = known == senders_.end();
    const auto entry = is_new ? senders_.end() - 1 : known;
    std::rotate(senders_.begin(), entry, entry + 1);
    Sender& sender = senders_.front();
    if (is_new) {
      sender = {epoch, sequence};
      return {Place::kNewer, 0};
    }
    if (sequence < sender.newest) return {Place::kOlder, 0};
    if (sequence == sender.newest) return {Place::kRepeat, 0};
    const std::int64_t missing = sequence - sender.newest - 1;
    sender.newest = sequence;
    return {Place::kNewer, missing};
  }

 private:
  struct Sender {
    std::int64_t epoch = -1;  // none: epochs are not negative
    std::int64_t newest = -1;
  };
  std::array<Sender, 16> senders_;  // the last heard first
};

}  // namespace gyrotwin
