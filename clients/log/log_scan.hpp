// The messages of a log that are of known types, for who turns them into something else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "clients/common/interrupt.hpp"
#include "clients/log/catalog.hpp"
#include "clients/log/selection.hpp"

namespace gyrotwin {

/// The messages of one type on one channel.
struct LogStream {
  std::string channel;
  std::string name;  ///< the channel's without the rig's prefix, as an identifier: "LIVE_STATE"
  std::uint64_t fingerprint = 0;
  std::int64_t messages = 0;  ///< given out
  std::int64_t meant = 0;     ///< selected, those among them that are passed over
};

/// One message on its way out of a log. Valid while it is given out.
struct LogMessage {
  std::size_t stream;  ///< index in streams()
  const LogEvent& event;
  const LcmType& type;
  double seconds;  ///< since the first message of the log, selected or not
};

/// Reads a log from its start to its end, as often as is asked for. Shows how far it is where
/// stderr is a terminal.
class LogScan {
 public:
  /// @param every of each stream, give out the first of so many messages
  LogScan(std::filesystem::path file, Selection selection, std::int64_t every = 1);
  ~LogScan();
  LogScan(const LogScan&) = delete;
  LogScan& operator=(const LogScan&) = delete;

  /// Gives out the messages in the order of the log.
  /// @throws Error when it cannot be read; NotDone when there is none, or on SIGINT and its like
  void read(const std::function<void(const LogMessage&)>& use);

  /// Shows what is being done, where stderr is a terminal. @throws NotDone on SIGINT and its like
  void show(const std::string& doing);

  /// What the last read() has come upon; the indices are those of the first one.
  const std::vector<LogStream>& streams() const { return streams_; }
  std::int64_t messages() const;  ///< of all streams
  const std::optional<About>& about() const { return about_; }
  const std::string& rig_file() const { return rig_file_; }
  const std::filesystem::path& file() const { return file_; }

  /// Tells on stderr what the log has lost, and what is of no known type.
  void tell_losses();

 private:
  std::size_t stream_of(const Catalog& catalog, const LogEvent& event, const LcmType& type);
  void clear();

  std::filesystem::path file_;
  Selection selection_;
  std::int64_t every_;
  std::vector<LogStream> streams_;
  std::map<std::string, std::vector<std::size_t>, std::less<>> by_channel_;
  std::set<std::string> names_;
  std::map<std::string, std::int64_t, std::less<>> unknown_;  // messages, by channel
  std::optional<About> about_;
  std::string rig_file_;
  std::string damage_;  // empty: none
  Interrupt interrupt_;
  bool terminal_;
  std::string shown_;
};

}  // namespace gyrotwin
