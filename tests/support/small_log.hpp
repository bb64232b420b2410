// A small log in memory: a message on each of a rig's channels, a foreign one, and what stands
// first in every log. Link gyrotwin_log_file.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "clients/log/log.hpp"
#include "services/runtime/datagram.hpp"
#include "tests/support/distinct.hpp"

namespace gyrotwin::support {

inline constexpr std::int32_t kSampleRig = 7;
inline constexpr std::size_t kForeignSize = 13;  ///< of the foreign message [byte]
inline const Key kSampleKey{1, 2, 3};

/// What is recorded of a message.
struct Content {
  std::string channel;
  LogBytes data;
  bool operator==(const Content&) const = default;
};

struct Sample {
  LogBytes bytes;
  std::vector<std::size_t> ends;  ///< of all events, the log's own among them [byte]
  std::vector<Content> contents;  ///< of the others
};

inline LogBytes sample_opening(bool is_signed, std::int64_t time_us) {
  const About about{.program = "test",
                    .host = "here",
                    .rig = "test",
                    .prefix = "TEST",
                    .rig_id = kSampleRig,
                    .key = is_signed ? fingerprint(kSampleKey) : "",
                    .channels = channels_of("TEST")};
  return opening_events(about, lcm_sources(), "[rig]\nname = \"test\"\n", time_us);
}

/// The message of a channel with distinct fields, signed or not.
inline Content sample_content(Channel channel, bool is_signed) {
  const DatagramFormat format("TEST", kSampleRig,
                              is_signed ? std::optional(kSampleKey) : std::nullopt);
  const LogBytes payload = distinct_payload(channel, kSampleRig);
  Frame frame{};
  const std::size_t at = format.begin(frame, channel, 0);
  std::memcpy(frame.data() + at, payload.data(), payload.size());
  format.sign(frame, at + payload.size());
  return {"TEST/" + std::string(spec(channel).suffix),
          {frame.begin() + static_cast<std::ptrdiff_t>(at),
           frame.begin() + static_cast<std::ptrdiff_t>(at + payload.size())}};
}

inline Sample small_log(bool is_signed) {
  constexpr std::int64_t kTime = 1'700'000'000'000'000;
  Sample sample;
  sample.bytes = sample_opening(is_signed, kTime);
  std::int64_t number = 0;
  for (std::size_t at = 0; at < sample.bytes.size(); ++number) {
    const std::size_t size = size_in_log(first_event(std::span(sample.bytes).subspan(at)));
    const LogEvent event = first_event(std::span(sample.bytes).subspan(at));
    LogBytes numbered;
    append_event(numbered, {number, kTime, event.channel, event.data});
    std::copy(numbered.begin(), numbered.end(),
              sample.bytes.begin() + static_cast<std::ptrdiff_t>(at));
    sample.ends.push_back(at += size);
  }
  for (const ChannelSpec& row : kChannels) {
    sample.contents.push_back(sample_content(row.channel, is_signed));
    if (row.channel == Channel::kReply) {
      sample.contents.push_back({"FOREIGN", LogBytes(kForeignSize, 1)});
    }
  }
  for (const Content& content : sample.contents) {
    append_event(sample.bytes, {number, kTime + 1000 * number, content.channel, content.data});
    sample.ends.push_back(sample.bytes.size());
    ++number;
  }
  return sample;
}

inline std::pair<ReadAt, std::int64_t> source(const LogBytes& bytes) {
  const auto held = std::make_shared<const LogBytes>(bytes);
  return {[held](std::int64_t offset, std::span<std::uint8_t> to) {
            const std::size_t count =
                std::min(to.size(), held->size() - static_cast<std::size_t>(offset));
            std::memcpy(to.data(), held->data() + offset, count);
            return count;
          },
          static_cast<std::int64_t>(bytes.size())};
}

/// The log that these bytes are, with the sample's key at hand.
inline Log open(const LogBytes& bytes) {
  return Log(source(bytes), [](const About&) { return kSampleKey; });
}

/// All messages that are left of a log.
inline std::vector<Content> contents(Log& log) {
  std::vector<Content> all;
  while (const auto event = log.next()) {
    if (is_log_channel(event->channel)) continue;
    all.push_back({std::string(event->channel), {event->data.begin(), event->data.end()}});
  }
  return all;
}

}  // namespace gyrotwin::support
