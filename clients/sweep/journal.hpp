// The folder of a sweep: what was asked, and the lines that are known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gyrotwin {

/// runs.csv in the order of the runs: a run's line is written as soon as all before it are, so that
/// the file is its own record of how far the sweep has come, whenever it was cut off; lines that
/// wait for one before them are lost then. sweep.json, there before it and whole, says which sweep
/// it is.
class Journal {
 public:
  /// Goes on with the folder's sweep, or begins it.
  /// @param definition of the sweep: whatever its lines hang on
  /// @throws Error when the folder holds another sweep, is in use or cannot be written
  Journal(std::filesystem::path folder, const nlohmann::json& definition,
          const std::string& header);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Runs whose lines are in the file: 0 to written() - 1.
  std::int64_t written() const { return written_; }
  /// @throws Error when it cannot be written
  void take(std::int64_t run, std::string line);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  void lock();
  void define(const nlohmann::json& definition) const;
  void write_whole(const std::filesystem::path& file, const std::string& text) const;
  void resume(const std::string& header);
  void put(const std::string& text);
  void close_all() const;
  [[noreturn]] void refuse(const std::string& why) const;

  std::filesystem::path folder_;
  int lock_ = -1;  // held for as long as this lives, and by workers that were forked meanwhile
  int file_ = -1;
  std::int64_t written_ = 0;
  std::map<std::int64_t, std::string> waiting_;
};

}  // namespace gyrotwin
