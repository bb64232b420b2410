// What a log says of itself in its first events, and what follows for the others. Normative text:
// messages/README.md, logs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/log/log_reader.hpp"
#include "services/runtime/key.hpp"
#include "services/schema/lcm_type.hpp"

namespace gyrotwin {

/// What every event on one of the rig's channels is.
struct LoggedChannel {
  std::string type;
  std::uint64_t fingerprint = 0;
  std::size_t size = 0;  ///< of the payload [byte]
};

/// Who recorded what.
struct About {
  std::string program;  ///< name and version
  std::string host;
  int part = 1;        ///< of a record in several files
  std::string rig;     ///< rig.name
  std::string prefix;  ///< network.prefix
  std::int32_t rig_id = 0;
  std::string key;  ///< fingerprint of the key that signs; empty: unsigned
  std::map<std::string, LoggedChannel, std::less<>> channels;  ///< by their whole names
};

/// The channels of a rig as this program knows them.
std::map<std::string, LoggedChannel, std::less<>> channels_of(const std::string& prefix);

/// A channel of the log's own, which no rig's can be: the alphabet of those has no small letters.
bool is_log_channel(std::string_view channel);

/// What an event on such a channel says; it must be sound.
std::string_view opening_text(const LogEvent& event);

/// The events that stand first in every file.
/// @param sources .lcm texts, each of one struct
/// @param rig_file the rig in effect, as TOML
LogBytes opening_events(const About& about, std::span<const std::string> sources,
                        std::string_view rig_file, std::int64_t time_us);

/// What is known of the channels and types of one log. Before the log has said anything: the types
/// of this program.
class Catalog {
 public:
  /// @param find_key the key with which the rig's messages are signed, if it is at hand
  using FindKey = std::function<std::optional<Key>(const About&)>;
  explicit Catalog(FindKey find_key);

  /// Learns from a sound event on a channel of the log's own. @return false when it makes no sense.
  bool take(const LogEvent& event);

  /// Whether this can be an event of the log.
  Soundness examine(const LogEvent& event) const;

  /// Type of the event's data, which has its size; null when unknown.
  const LcmType* type_of(const LogEvent& event) const;

  const std::optional<About>& about() const { return about_; }
  const std::string& rig_file() const { return rig_file_; }
  bool checks_signatures() const { return key_.has_value(); }

 private:
  Soundness examine_rig_message(const LogEvent& event, const LoggedChannel& channel) const;
  bool take_type(std::string_view text);
  bool is_of_rig(const LogEvent& event, const LcmType& type) const;

  FindKey find_key_;
  std::vector<std::string> sources_;  // of types_, later ones over earlier
  LcmTypes types_;
  std::optional<About> about_;
  std::optional<Key> key_;
  std::string rig_file_;
};

}  // namespace gyrotwin
