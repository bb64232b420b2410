// Which messages of a log are meant.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "clients/log/log_file.hpp"

namespace gyrotwin {

/// Channels and a stretch of time, as on the command line.
struct Selection {
  std::vector<std::string> channels;  ///< whole names, or ends of them behind a `/`; none: all
  /// Since the first message [s]; those behind it may have been stamped before it.
  double from_s = -1e12;
  double to_s = 1e12;  ///< likewise; included
};

/// Picks messages from a log that is read from its start.
class Picker {
 public:
  explicit Picker(const Selection& selection) : selection_(selection) {}

  /// Whether this event is meant; to be asked about each, in order. Of the log's own events, which
  /// have no time, those on channels that the selection names.
  bool takes(const LogEvent& event);

  /// Of the event asked about last: since the first message [s].
  double seconds() const { return seconds_; }

  /// @throws NotDone when nothing was meant, naming the channels there are
  void require_some() const;

 private:
  bool names(std::string_view channel) const;

  Selection selection_;
  std::optional<std::int64_t> begin_us_;
  double seconds_ = 0.0;
  std::int64_t taken_ = 0;
  std::vector<std::string> seen_;  // channels that were not named
};

}  // namespace gyrotwin
