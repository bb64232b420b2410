// Recordings that operators start and stop: `gyrotwin log record` as a child.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "services/gateway/foxglove.hpp"

namespace gyrotwin {

class Recorder {
 public:
  /// @param folder of the recordings, made when the first one begins
  /// @param rig_arguments `--rig` and `--set` words of the rig that is recorded
  Recorder(std::string rig_name, std::filesystem::path folder,
           std::vector<std::string> rig_arguments);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Begins or ends a recording; what is so already stays. @return look()
  foxglove::Json wish(bool on);

  /// {"on", "file", "bytes"}; "error" after one that failed.
  foxglove::Json look();

  /// Names and sizes of the recordings there are, the newest first.
  foxglove::Json list() const;
  /// The file of a recording by its name; empty for what is none.
  std::filesystem::path find(std::string_view name) const;

 private:
  void begin();

  std::string rig_name_;
  std::filesystem::path folder_;
  std::vector<std::string> rig_arguments_;
  pid_t child_ = 0;  // 0: none
  bool ending_ = false;
  std::string file_, error_;  // of the last recording
};

}  // namespace gyrotwin
