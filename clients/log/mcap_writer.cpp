#include "clients/log/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kPrefix = 9;       // opcode and length [byte]
constexpr std::size_t kChunk = 1 << 20;  // a chunk ends when it has as many [byte]
constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max();  // schemas, channels
constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunkOf = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

Bytes bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::uint32_t crc_of(Bytes bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

}  // namespace

McapRecord::McapRecord(std::uint8_t opcode) : bytes_(kPrefix) { bytes_[0] = opcode; }

McapRecord& McapRecord::bytes(Bytes bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return *this;
}

McapRecord& McapRecord::text(std::string_view text) {
  return number(static_cast<std::uint32_t>(text.size())).bytes(bytes_of(text));
}

McapRecord& McapRecord::map(const std::map<std::string, std::string>& map) {
  std::size_t size = 0;
  for (const auto& [key, value] : map)
    size += 2 * sizeof(std::uint32_t) + key.size() + value.size();
  number(static_cast<std::uint32_t>(size));
  for (const auto& [key, value] : map) text(key).text(value);
  return *this;
}

McapRecord& McapRecord::map(const std::map<std::uint16_t, std::uint64_t>& map) {
  number(static_cast<std::uint32_t>(map.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [key, value] : map) number(key).number(value);
  return *this;
}

McapRecord& McapRecord::crc() { return number(crc_of(Bytes(bytes_).subspan(kPrefix))); }

Bytes McapRecord::finish() {
  const std::uint64_t length = bytes_.size() - kPrefix;
  for (std::size_t i = 0; i < sizeof length; ++i) {
    bytes_[1 + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
  return bytes_;
}

void McapWriter::Times::take(std::uint64_t time_ns) {
  first = any ? std::min(first, time_ns) : time_ns;
  last = any ? std::max(last, time_ns) : time_ns;
  any = true;
}

McapWriter::McapWriter(OutputFile& file, bool compress, std::string_view library)
    : file_(file), compressor_(compress ? ZSTD_createCCtx() : nullptr, ZSTD_freeCCtx) {
  put(bytes_of(kMagic));
  put(McapRecord(kHeader).text("ros2").text(library));
}

McapWriter::~McapWriter() = default;

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view definition) {
  if (schemas_.size() == kMost) throw NotDone("MCAP holds no more than 65535 types");
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  add_to_chunk(McapRecord(kSchema).number(id).text(name).text("ros2msg").text(definition),
               schemas_);
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, std::string_view topic) {
  if (channels_.size() == kMost) throw NotDone("MCAP holds no more than 65535 channels");
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  add_to_chunk(McapRecord(kChannel).number(id).number(schema).text(topic).text("cdr").map(
                   std::map<std::string, std::string>{{"offered_qos_profiles", ""}}),
               channels_);
  return id;
}

void McapWriter::add_to_chunk(McapRecord record, std::vector<McapRecord>& list) {
  const Bytes bytes = record.finish();
  chunk_.insert(chunk_.end(), bytes.begin(), bytes.end());
  list.push_back(std::move(record));
}

void McapWriter::add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                             Bytes cdr) {
  index_[channel].emplace_back(time_ns, chunk_.size());
  ++counts_[channel];
  times_.take(time_ns);
  chunk_times_.take(time_ns);
  McapRecord record(kMessage);
  const Bytes bytes =
      record.number(channel).number(sequence).number(time_ns).number(time_ns).bytes(cdr).finish();
  chunk_.insert(chunk_.end(), bytes.begin(), bytes.end());
  if (chunk_.size() >= kChunk) finish_chunk();
}

std::string_view McapWriter::compressed() {
  if (!compressor_) return {reinterpret_cast<const char*>(chunk_.data()), chunk_.size()};
  packed_.resize(ZSTD_compressBound(chunk_.size()));
  const std::size_t size = ZSTD_compressCCtx(compressor_.get(), packed_.data(), packed_.size(),
                                             chunk_.data(), chunk_.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) throw NotDone(std::string("zstd: ") + ZSTD_getErrorName(size));
  return {packed_.data(), size};
}

void McapWriter::finish_chunk() {
  if (chunk_.empty()) return;
  const std::string_view compression = compressor_ ? "zstd" : "";
  const std::string_view records = compressed();
  const Place chunk = put(McapRecord(kChunkOf)
                              .number(chunk_times_.first)
                              .number(chunk_times_.last)
                              .number(std::uint64_t{chunk_.size()})
                              .number(crc_of(chunk_))
                              .text(compression)
                              .number(std::uint64_t{records.size()})
                              .bytes(bytes_of(records)));
  std::map<std::uint16_t, std::uint64_t> places;
  const std::int64_t begin = file_.size();
  for (auto& [channel, messages] : index_) {
    if (messages.empty()) continue;
    McapRecord record(kMessageIndex);
    record.number(channel).number(static_cast<std::uint32_t>(messages.size() * 16));
    for (const auto& [time_ns, offset] : messages) record.number(time_ns).number(offset);
    places[channel] = put(record).offset;
    messages.clear();
  }
  chunk_indices_.push_back(McapRecord(kChunkIndex)
                               .number(chunk_times_.first)
                               .number(chunk_times_.last)
                               .number(chunk.offset)
                               .number(chunk.length)
                               .map(places)
                               .number(static_cast<std::uint64_t>(file_.size() - begin))
                               .text(compression)
                               .number(std::uint64_t{records.size()})
                               .number(std::uint64_t{chunk_.size()}));
  chunk_.clear();
  chunk_times_ = {};
}

void McapWriter::add_attachment(std::string_view name, std::string_view media_type,
                                std::string_view data, std::uint64_t time_ns) {
  constexpr std::uint64_t kUnknown = 0;  // when it was made
  const Place place = put(McapRecord(kAttachment)
                              .number(time_ns)
                              .number(kUnknown)
                              .text(name)
                              .text(media_type)
                              .number(std::uint64_t{data.size()})
                              .bytes(bytes_of(data))
                              .crc());
  attachment_indices_.push_back(McapRecord(kAttachmentIndex)
                                    .number(place.offset)
                                    .number(place.length)
                                    .number(time_ns)
                                    .number(kUnknown)
                                    .number(std::uint64_t{data.size()})
                                    .text(name)
                                    .text(media_type));
}

void McapWriter::add_metadata(std::string_view name,
                              const std::map<std::string, std::string>& metadata) {
  const Place place = put(McapRecord(kMetadata).text(name).map(metadata));
  metadata_indices_.push_back(
      McapRecord(kMetadataIndex).number(place.offset).number(place.length).text(name));
}

McapRecord McapWriter::statistics() const {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  return McapRecord(kStatistics)
      .number(messages)
      .number(static_cast<std::uint16_t>(schemas_.size()))
      .number(static_cast<std::uint32_t>(channels_.size()))
      .number(static_cast<std::uint32_t>(attachment_indices_.size()))
      .number(static_cast<std::uint32_t>(metadata_indices_.size()))
      .number(static_cast<std::uint32_t>(chunk_indices_.size()))
      .number(times_.first)
      .number(times_.last)
      .map(counts_);
}

void McapWriter::finish() {
  finish_chunk();
  put(McapRecord(kDataEnd).number(crc_));

  const auto summary = static_cast<std::uint64_t>(file_.size());
  crc_ = 0;
  std::vector<McapRecord> statistics{this->statistics()}, offsets;
  const auto put_group = [&](Opcode opcode, std::vector<McapRecord>& records) {
    if (records.empty()) return;
    const auto begin = static_cast<std::uint64_t>(file_.size());
    for (McapRecord& record : records) put(record);
    offsets.push_back(McapRecord(kSummaryOffset)
                          .number(std::uint8_t{opcode})
                          .number(begin)
                          .number(static_cast<std::uint64_t>(file_.size()) - begin));
  };
  put_group(kSchema, schemas_);
  put_group(kChannel, channels_);
  put_group(kStatistics, statistics);
  put_group(kChunkIndex, chunk_indices_);
  put_group(kAttachmentIndex, attachment_indices_);
  put_group(kMetadataIndex, metadata_indices_);
  const auto summary_offsets = static_cast<std::uint64_t>(file_.size());
  for (McapRecord& offset : offsets) put(offset);

  McapRecord footer(kFooter);
  footer.number(summary).number(summary_offsets);
  // Its sum is over the summary and the footer up to the sum itself, the length that it will have
  // included.
  McapRecord whole = footer;
  const Bytes bytes = whole.number(std::uint32_t{0}).finish();
  put(footer.number(crc_of(bytes.first(bytes.size() - sizeof(std::uint32_t)), crc_)));
  put(bytes_of(kMagic));
}

McapWriter::Place McapWriter::put(McapRecord& record) {
  const auto offset = static_cast<std::uint64_t>(file_.size());
  const Bytes bytes = record.finish();
  put(bytes);
  return {offset, bytes.size()};
}

void McapWriter::put(Bytes bytes) {
  crc_ = crc_of(bytes, crc_);
  file_.write(bytes);
}

}  // namespace gyrotwin
