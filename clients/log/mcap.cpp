#include "clients/log/mcap.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "clients/log/export_file.hpp"
#include "clients/log/mcap_writer.hpp"
#include "services/schema/ros2_message.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kMicrosecond = 1000;  // [ns]

/// A damaged log may have times that no such file can hold.
std::uint64_t nanoseconds(std::int64_t time_us) {
  constexpr std::int64_t kLatest = std::numeric_limits<std::int64_t>::max() / kMicrosecond;
  return static_cast<std::uint64_t>(std::clamp<std::int64_t>(time_us, 0, kLatest) * kMicrosecond);
}

/// One stream as a channel of the file.
struct McapChannel {
  Ros2Message format;
  std::uint16_t id;
  std::optional<LcmNumber> sequence;

  std::uint32_t sequence_of(std::span<const std::uint8_t> payload) const {
    if (!sequence) return 0;
    const std::int64_t number = integer_at(payload, *sequence);
    constexpr std::int64_t kLargest = std::numeric_limits<std::uint32_t>::max();
    return number < 0 || number > kLargest ? 0 : static_cast<std::uint32_t>(number);
  }
};

std::map<std::string, std::string> metadata_of(const About& about,
                                               const std::filesystem::path& log) {
  return {{"log", log.filename().string()},
          {"recorded_by", about.program},
          {"host", about.host},
          {"part", std::to_string(about.part)},
          {"rig", about.rig},
          {"prefix", about.prefix},
          {"rig_id", std::to_string(about.rig_id)},
          {"key", about.key}};
}

}  // namespace

void export_mcap(LogScan& scan, const std::filesystem::path& out, bool overwrite, bool compress) {
  OutputFile file(out, overwrite);
  McapWriter writer(file, compress, "gyrotwin-log " GYROTWIN_VERSION);
  std::map<std::uint64_t, std::uint16_t> schemas;  // by fingerprint
  std::vector<McapChannel> channels;
  std::vector<std::uint8_t> cdr;
  std::uint64_t time_ns = 0;
  scan.read([&](const LogMessage& message) {
    if (message.stream == channels.size()) {
      Ros2Message format(message.type);
      auto schema = schemas.find(message.type.fingerprint);
      if (schema == schemas.end()) {
        const std::uint16_t id = writer.add_schema(format.name(), format.definition());
        schema = schemas.emplace(message.type.fingerprint, id).first;
      }
      const std::uint16_t id =
          writer.add_channel(schema->second, scan.streams()[message.stream].channel);
      channels.push_back({std::move(format), id, locate(message.type, "header.sequence")});
    }
    const McapChannel& channel = channels[message.stream];
    cdr.clear();
    channel.format.encode(message.event.data, cdr);
    time_ns = nanoseconds(message.event.time_us);
    writer.add_message(channel.id, channel.sequence_of(message.event.data), time_ns, cdr);
  });
  if (!scan.rig_file().empty()) {
    writer.add_attachment("rig.toml", "application/toml", scan.rig_file(), time_ns);
  }
  if (scan.about()) writer.add_metadata("gyrotwin", metadata_of(*scan.about(), scan.file()));
  writer.finish();
  file.finish();
}

}  // namespace gyrotwin
