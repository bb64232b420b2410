// Reading LCM logs that may be damaged: cut anywhere, bytes changed, missing or put in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "clients/log/log_file.hpp"

namespace gyrotwin {

/// Reads bytes of a log from `offset` on. @return how many; fewer than asked for only at the end.
using ReadAt = std::function<std::size_t(std::int64_t offset, std::span<std::uint8_t> to)>;

/// What is known of an event besides that it has the form of one.
enum class Soundness : std::uint8_t {
  kUnknown,         ///< nothing is known of such a channel
  kRightShape,      ///< of its channel's type and size
  kAuthentic,       ///< and its signature is right
  kWrongShape,      ///< not of its channel's type or size
  kWrongSignature,  ///< of the right shape, and altered or of somebody else
};
using Examine = std::function<Soundness(const LogEvent&)>;

/// What a log has lost.
struct Damage {
  std::int64_t bytes_lost = 0;       ///< of no event that was read
  std::int64_t events_lost = 0;      ///< as far as event numbers tell; those below are among them
  std::int64_t wrong_shape = 0;      ///< dropped: not of their channel's type or size
  std::int64_t wrong_signature = 0;  ///< dropped: altered, or of somebody else
  std::int64_t times_repaired = 0;   ///< read with the time of the event before
  bool any() const { return bytes_lost + events_lost + times_repaired > 0; }
};

/// Every event of a log in which nothing speaks for damage, in order. Never fails: what cannot be
/// an event is passed over and counted.
class LogReader {
 public:
  /// @param size of the log [byte]
  /// @param examine asked about every event, some more than once
  LogReader(ReadAt read, std::int64_t size, Examine examine)
      : read_(std::move(read)), size_(size), examine_(std::move(examine)) {}

  /// The next event, valid until the next call; empty at the end.
  std::optional<LogEvent> next();

  /// So far; the loss at the end of a file is known when next() has returned empty.
  const Damage& damage() const { return damage_; }
  std::int64_t size() const { return size_; }  ///< of the log [byte]

 private:
  /// Bytes that have the form of an event.
  struct Frame {
    std::int64_t begin, end;  // offsets
    std::int64_t number, time_us;
    std::size_t channel_size;
  };
  using MaybeFrame = std::optional<Frame>;
  enum class Sync : std::uint8_t { kRight, kAny };

  std::span<const std::uint8_t> bytes(std::int64_t offset, std::int64_t size);
  std::int64_t find_sync(std::int64_t from, std::int64_t before);
  MaybeFrame frame_at(std::int64_t offset, Sync sync = Sync::kRight);
  MaybeFrame find_frame(std::int64_t from, std::int64_t before);
  MaybeFrame find_followed_frame(std::int64_t from, std::int64_t before);
  LogEvent event_of(const Frame& frame);

  bool is_followed(const Frame& frame);
  bool is_contradicted(const Frame& frame, Soundness soundness);
  bool is_sound(const Frame& frame);
  void lose_tail();
  void take_number(const Frame& frame, const MaybeFrame& next);
  void repair_time(Frame& frame, const MaybeFrame& next);

  ReadAt read_;
  std::int64_t size_;
  Examine examine_;
  std::int64_t position_ = 0;            // where the next event should begin
  std::int64_t expected_ = 0;            // its number
  std::optional<std::int64_t> time_us_;  // of the last event
  Damage damage_;

  std::vector<std::uint8_t> window_;  // of the log, from window_at_ on
  std::int64_t window_at_ = 0;
};

}  // namespace gyrotwin
