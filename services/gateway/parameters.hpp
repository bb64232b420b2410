// The rig file as parameters, `structure.mass_kg`, and what can be set. Pure.
#pragma once

#include <string>
#include <string_view>

#include "services/gateway/foxglove.hpp"

namespace gyrotwin {

class Parameters {
 public:
  /// The one that an operator may set: true or false. It reads as an object.
  static constexpr std::string_view kRecording = "recording";

  /// @param rig_text the rig file in effect, as TOML
  explicit Parameters(std::string_view rig_text);

  /// Those that are asked for by name, all for no name; unknown ones are left out.
  foxglove::Json pick(const foxglove::Json& names) const;
  bool has(std::string_view name) const { return values_.contains(name); }
  void set_recording(const foxglove::Json& recording) {
    values_[std::string(kRecording)] = recording;
  }
  const foxglove::Json& recording() const { return values_.at(std::string(kRecording)); }

 private:
  foxglove::Json values_;
};

}  // namespace gyrotwin
