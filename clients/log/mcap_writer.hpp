// MCAP, the container that Foxglove, Lichtblick and PlotJuggler read, as mcap.dev/spec has it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/log/export_file.hpp"
#include "services/schema/little_endian.hpp"

struct ZSTD_CCtx_s;

namespace gyrotwin {

/// One record under construction: opcode, length, content; little endian.
class McapRecord {
 public:
  explicit McapRecord(std::uint8_t opcode);

  template <class Unsigned>
  McapRecord& number(Unsigned value) {
    append_little_endian(bytes_, value);
    return *this;
  }
  McapRecord& bytes(std::span<const std::uint8_t> bytes);
  McapRecord& text(std::string_view text);  ///< behind its length, 32 bits
  McapRecord& map(const std::map<std::string, std::string>& map);
  McapRecord& map(const std::map<std::uint16_t, std::uint64_t>& map);
  /// CRC-32 of the content so far.
  McapRecord& crc();
  std::span<const std::uint8_t> finish();

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Writes one file: messages in chunks with an index each, everything listed again in the summary,
/// checksums throughout. Times are in ns since 1970.
class McapWriter {
 public:
  /// @param compress chunks with zstd, or leave them as they are
  McapWriter(OutputFile& file, bool compress, std::string_view library);
  ~McapWriter();

  /// A ros2msg schema. @return its id @throws NotDone when the format has no id left
  std::uint16_t add_schema(std::string_view name, std::string_view definition);
  /// A topic with messages in CDR. @return its id @throws NotDone when the format has no id left
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic);
  void add_message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                   std::span<const std::uint8_t> cdr);
  void add_attachment(std::string_view name, std::string_view media_type, std::string_view data,
                      std::uint64_t time_ns);
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& metadata);

  /// Writes the summary; nothing may be added after it.
  void finish();

 private:
  struct Times {
    std::uint64_t first = 0, last = 0;
    bool any = false;
    void take(std::uint64_t time_ns);
  };
  struct Place {
    std::uint64_t offset, length;
  };

  Place put(McapRecord& record);
  void put(std::span<const std::uint8_t> bytes);
  void add_to_chunk(McapRecord record, std::vector<McapRecord>& list);
  void finish_chunk();
  std::string_view compressed();
  McapRecord statistics() const;

  OutputFile& file_;
  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> compressor_;  // null: none
  std::uint32_t crc_ = 0;

  std::vector<std::uint8_t> chunk_;
  std::vector<char> packed_;
  Times chunk_times_, times_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::map<std::uint16_t, std::uint64_t> counts_;  // messages, by channel

  // What the summary repeats and lists.
  std::vector<McapRecord> schemas_, channels_, chunk_indices_, attachment_indices_,
      metadata_indices_;
};

}  // namespace gyrotwin
