// LCM's log file format, as lcm-logger writes it: one event after another, each
//   sync word 0xEDA1DA01, 32 bits | event number, 64 | time [us since 1970], 64 |
//   length of the channel's name, 32 | length of the data, 32 | name | data
// all big endian. Written here; read in log_reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "services/runtime/descriptor.hpp"

namespace gyrotwin {

inline constexpr std::uint32_t kLogSync = 0xEDA1DA01;
inline constexpr std::size_t kLogHeader = 28;  ///< bytes before the channel's name

using LogBytes = std::vector<std::uint8_t>;

/// One event; name and data belong to whoever made it.
struct LogEvent {
  std::int64_t number = 0;   ///< counts the events of a file from 0
  std::int64_t time_us = 0;  ///< since 1970 [us]
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// Lays the event out behind what is there.
void append_event(LogBytes& to, const LogEvent& event);

/// The event at the start of these bytes, which append_event has laid out.
LogEvent first_event(std::span<const std::uint8_t> events);

/// Bytes of an event in a file.
inline std::size_t size_in_log(const LogEvent& event) {
  return kLogHeader + event.channel.size() + event.data.size();
}

/// A log being written: events are in the file (the kernel's page cache) when append() returns.
class LogWriter {
 public:
  /// Makes a new file.
  /// @throws Error when it exists already or cannot be made
  explicit LogWriter(std::filesystem::path path);

  /// Writes whole events, laid out by append_event, and numbers them in place.
  /// @throws NotDone when the disk takes no more; what stands in the file then ends with a whole
  ///         event, and events() and size() count what stands there
  void append(std::span<std::uint8_t> events);

  const std::filesystem::path& path() const { return path_; }
  std::int64_t events() const { return events_; }
  std::int64_t size() const { return size_; }  ///< [byte]
  int descriptor() const { return file_.get(); }

 private:
  [[noreturn]] void give_up(std::span<const std::uint8_t> events, std::size_t written);

  std::filesystem::path path_;
  Descriptor file_;
  std::int64_t events_ = 0, size_ = 0;
};

}  // namespace gyrotwin
