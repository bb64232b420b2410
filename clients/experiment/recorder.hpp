// A `gyrotwin log record` that runs meanwhile.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace gyrotwin {

/// Records from construction to stop(), which a destructor does too.
class Recorder {
 public:
  /// Returns when the file is being written.
  /// @param rig_words `--rig` and `--set` words as on this program's command line
  /// @throws NotDone when it does not begin
  Recorder(const std::string& file, const std::vector<std::string>& rig_words);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Has everything written that was heard. @throws NotDone when the record is not whole
  void stop();
  /// @throws NotDone when it has ended by itself
  void require_running();

 private:
  int wait(bool hang);

  pid_t process_ = -1;
};

}  // namespace gyrotwin
