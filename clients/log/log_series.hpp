// A record in one file or several, each readable alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <system_error>

#include "clients/log/log_file.hpp"

namespace gyrotwin {

/// Files of one record, one after the other, without a gap between.
class LogSeries {
 public:
  /// When a file is full, and how many stay, the last one included; 0: never, and all.
  struct Limits {
    std::int64_t bytes = 0;
    std::int64_t time_us = 0;
    int keep = 0;
    bool any() const { return bytes > 0 || time_us > 0; }
  };
  /// The events that stand first in a file. @param part of the record, from 1
  using Opening = std::function<LogBytes(int part, std::int64_t time_us)>;
  /// Told of every file that gets no more.
  using Finished = std::function<void(const LogWriter&)>;

  /// Makes the first file: `path`, or with limits `path` numbered: run.000001.lcm.
  /// @throws Error when it, or another numbered one, exists already, or it cannot be made; NotDone
  ///         when it cannot be written
  LogSeries(std::filesystem::path path, Limits limits, Opening opening, Finished finished,
            std::int64_t time_us);

  /// Writes events, each whole into one file.
  /// @throws NotDone when no more can be written; what was is kept
  void append(std::span<std::uint8_t> events);

  /// As it was given, without a number.
  const std::filesystem::path& path() const { return path_; }
  const LogWriter& file() const { return *file_; }  ///< the last
  int files() const { return part_; }               ///< made
  int removed() const { return removed_; }          ///< of them, the oldest
  /// Why the oldest file, which should, did not go; it is tried again with the next file.
  const std::error_code& removal_error() const { return removal_error_; }
  std::int64_t events() const { return events_; }  ///< without the opening ones
  std::int64_t size() const {
    return finished_size_ + file_->size();
  }  ///< of all files made [byte]

 private:
  void open_next(std::int64_t time_us);
  void remove_oldest();
  void write(std::span<std::uint8_t> events);
  bool is_full_for(const LogEvent& event, std::size_t waiting) const;

  std::filesystem::path path_;
  Limits limits_;
  Opening opening_;
  Finished finished_;
  std::optional<LogWriter> file_;
  int part_ = 0, removed_ = 0;
  std::error_code removal_error_;
  std::int64_t opened_us_ = 0;       // when the last file begins
  std::int64_t opening_events_ = 0;  // in the last file
  std::int64_t events_ = 0, finished_size_ = 0;
};

/// "run.lcm" and 3: "run.000003.lcm"; a file a minute is sorted by name for two years.
std::filesystem::path numbered(const std::filesystem::path& path, int part);

}  // namespace gyrotwin
