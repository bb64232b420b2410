#include "clients/log/log_reader.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "messages/big_endian.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kHeader = kLogHeader;
constexpr std::int64_t kSyncSize = 4;
constexpr std::array<std::uint8_t, kSyncSize> kSyncBytes{0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kLongestChannel = 63;      // that liblcm knows
constexpr std::int64_t kLargestData = 64 << 20;  // that is believed
constexpr std::int64_t kWindow = 1 << 20;
constexpr std::int64_t kFarthestLook = 1 << 20;  // for what contradicts an event
// Clocks of several cores may disagree a little, and a clock may be set.
constexpr std::int64_t kClockSlack = 1'000'000;  // [us]

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

bool visible(std::span<const std::uint8_t> name) {
  return std::ranges::all_of(name, [](std::uint8_t c) { return c >= ' ' && c <= '~'; });
}

/// b - a without overflow, both any.
std::int64_t distance(std::int64_t a, std::int64_t b) {
  std::int64_t difference = 0;
  return __builtin_sub_overflow(b, a, &difference) ? kMost : difference;
}

void add(std::int64_t& sum, std::int64_t more) { sum = more > kMost - sum ? kMost : sum + more; }

}  // namespace

std::optional<LogEvent> LogReader::next() {
  for (std::int64_t from = position_;;) {
    MaybeFrame frame = find_frame(from, size_);
    if (!frame) {
      lose_tail();
      return {};
    }
    if (!is_sound(*frame)) {
      from = frame->begin + 1;
      continue;
    }
    const MaybeFrame behind = frame_at(frame->end);
    take_number(*frame, behind);
    repair_time(*frame, behind);
    add(damage_.bytes_lost, frame->begin - position_);
    position_ = frame->end;
    return event_of(*frame);
  }
}

/// Up to `size` bytes, valid until the next call; what the disk does not give reads as zeros.
std::span<const std::uint8_t> LogReader::bytes(std::int64_t offset, std::int64_t size) {
  size = std::clamp<std::int64_t>(size, 0, size_ - offset);
  const auto held = static_cast<std::int64_t>(window_.size());
  if (offset < window_at_ || offset + size > window_at_ + held) {
    const std::int64_t wanted = std::min(std::max(size, kWindow), size_ - offset);
    window_.resize(static_cast<std::size_t>(wanted));
    window_at_ = offset;
    const std::size_t got = read_(offset, window_);
    std::fill(window_.begin() + static_cast<std::ptrdiff_t>(got), window_.end(), std::uint8_t{0});
  }
  return std::span<const std::uint8_t>(window_).subspan(
      static_cast<std::size_t>(offset - window_at_), static_cast<std::size_t>(size));
}

/// Offset of the first sync word that begins in [from, before); `before` when there is none.
std::int64_t LogReader::find_sync(std::int64_t from, std::int64_t before) {
  // Nearly always it is right there; then the window stays where it is.
  if (from < before && std::ranges::equal(bytes(from, kSyncSize), kSyncBytes)) return from;
  while (from < before) {
    // Steps of a window, each a little into the next, so that no word is cut.
    const auto piece = bytes(from, std::min(kWindow, before - from + kSyncSize - 1));
    const auto found =
        std::search(piece.begin(), piece.end(), kSyncBytes.begin(), kSyncBytes.end());
    const std::int64_t at = from + (found - piece.begin());
    if (found != piece.end()) return std::min(at, before);
    from += std::max<std::int64_t>(static_cast<std::int64_t>(piece.size()) - kSyncSize + 1, 1);
  }
  return before;
}

LogReader::MaybeFrame LogReader::frame_at(std::int64_t offset, Sync sync) {
  if (size_ - offset < kHeader) return {};
  const auto header = bytes(offset, kHeader);
  if (sync == Sync::kRight && big_endian<std::uint32_t>(header, 0) != kLogSync) return {};
  Frame frame{};
  frame.begin = offset;
  frame.number = static_cast<std::int64_t>(big_endian<std::uint64_t>(header, 4));
  frame.time_us = static_cast<std::int64_t>(big_endian<std::uint64_t>(header, 12));
  frame.channel_size = big_endian<std::uint32_t>(header, 20);
  const std::int64_t data_size = big_endian<std::uint32_t>(header, 24);
  if (frame.channel_size < 1 || frame.channel_size > kLongestChannel) return {};
  if (data_size > kLargestData) return {};
  const auto channel_size = static_cast<std::int64_t>(frame.channel_size);
  frame.end = offset + kHeader + channel_size + data_size;
  if (frame.end > size_ || !visible(bytes(offset + kHeader, channel_size))) return {};
  return frame;
}

LogReader::MaybeFrame LogReader::find_frame(std::int64_t from, std::int64_t before) {
  before = std::min(before, size_);
  while ((from = find_sync(from, before)) < before) {
    if (const MaybeFrame frame = frame_at(from)) return frame;
    ++from;
  }
  return {};
}

LogReader::MaybeFrame LogReader::find_followed_frame(std::int64_t from, std::int64_t before) {
  while (const MaybeFrame frame = find_frame(from, before)) {
    if (is_followed(*frame)) return frame;
    from = frame->begin + 1;
  }
  return {};
}

LogEvent LogReader::event_of(const Frame& frame) {
  const auto all = bytes(frame.begin, frame.end - frame.begin);
  return {.number = frame.number,
          .time_us = frame.time_us,
          .channel = {reinterpret_cast<const char*>(all.data()) + kHeader, frame.channel_size},
          .data = all.subspan(kLogHeader + frame.channel_size)};
}

/// Behind it the log ends, or a sync word begins.
bool LogReader::is_followed(const Frame& frame) {
  const auto behind = bytes(frame.end, kSyncSize);
  return std::equal(behind.begin(), behind.end(), kSyncBytes.begin());
}

/// Whether its neighbours say that its lengths are wrong.
bool LogReader::is_contradicted(const Frame& frame, Soundness soundness) {
  const bool followed = is_followed(frame);
  const MaybeFrame behind = frame_at(frame.end);
  const std::int64_t after = frame.number == kMost ? kMost : frame.number + 1;
  if (followed && (frame.end == size_ || (behind && behind->number == after))) return false;

  // Too long: it holds others.
  const std::int64_t inner_end = std::min(frame.end, frame.begin + kFarthestLook);
  if (find_followed_frame(frame.begin + kSyncSize, inner_end)) return true;
  if (followed || soundness == Soundness::kRightShape) return false;

  // Too short: no number is missing up to the next, so what lies between is a part of it.
  const MaybeFrame next = find_followed_frame(frame.end, frame.end + kFarthestLook);
  if (next) return next->number == after;
  // At the end of a log, one more event with a damaged sync word may follow, and nothing else.
  const MaybeFrame last = frame_at(frame.end, Sync::kAny);
  return !last || !is_followed(*last);
}

bool LogReader::is_sound(const Frame& frame) {
  const Soundness soundness = examine_(event_of(frame));
  switch (soundness) {
    case Soundness::kAuthentic:
      return true;
    case Soundness::kWrongShape:
      if (is_followed(frame)) ++damage_.wrong_shape;
      return false;
    case Soundness::kWrongSignature:
      if (is_followed(frame)) ++damage_.wrong_signature;
      return false;
    case Soundness::kUnknown:
    case Soundness::kRightShape:
      break;
  }
  return !is_contradicted(frame, soundness);
}

/// No event any more: each sync word that is left was one, and whatever is left was one at least.
void LogReader::lose_tail() {
  if (position_ == size_) return;
  std::int64_t events = 0;
  for (std::int64_t at = position_; (at = find_sync(at, size_)) < size_; ++at) ++events;
  add(damage_.events_lost, std::max<std::int64_t>(events, 1));
  add(damage_.bytes_lost, size_ - position_);
  position_ = size_;
}

/// Counts the numbers left out. A number that the next event does not confirm is taken for damaged:
/// where it was not, the next one brings up the same difference.
void LogReader::take_number(const Frame& frame, const MaybeFrame& next) {
  const bool confirmed =
      next ? frame.number != kMost && next->number == frame.number + 1 : frame.end == size_;
  if (frame.number == expected_ || !confirmed) {
    ++expected_;
    return;
  }
  const std::int64_t missing =
      frame.number > expected_ ? distance(expected_, frame.number) : 0;  // else: numbered anew
  // A last event's number is believed as far as there was room for the missing.
  const std::int64_t room = next ? kMost : (frame.begin - position_) / kHeader;
  if (missing > 0 && missing <= room) add(damage_.events_lost, missing);
  expected_ = frame.number == kMost ? 0 : frame.number + 1;
}

/// An event between two that are in order is in order too.
void LogReader::repair_time(Frame& frame, const MaybeFrame& next) {
  if (time_us_ && next && *time_us_ <= next->time_us &&
      (distance(frame.time_us, *time_us_) > kClockSlack ||
       distance(next->time_us, frame.time_us) > kClockSlack)) {
    frame.time_us = *time_us_;
    ++damage_.times_repaired;
  }
  time_us_ = frame.time_us;
}

}  // namespace gyrotwin
