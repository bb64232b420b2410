// A log as a file, read event by event by what it says of itself.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "clients/log/catalog.hpp"
#include "clients/log/log_reader.hpp"

namespace gyrotwin {

/// Every sound event of a log, its own opening ones among them.
class Log {
 public:
  /// @throws Error when the file cannot be read
  explicit Log(const std::filesystem::path& path);
  /// A log that is no file.
  /// @param source how to read it, and its size [byte]
  Log(std::pair<ReadAt, std::int64_t> source, Catalog::FindKey find_key);
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  /// The next event, valid until the next call; empty at the end.
  std::optional<LogEvent> next();

  const Catalog& catalog() const { return catalog_; }
  const Damage& damage() const { return reader_.damage(); }
  std::int64_t size() const { return reader_.size(); }  ///< [byte]

  /// "none", or what is lost and what was not checked.
  std::string damage_text() const;

 private:
  Catalog catalog_;
  LogReader reader_;
  std::int64_t senseless_ = 0;  // events of the log's own that say nothing
};

}  // namespace gyrotwin
