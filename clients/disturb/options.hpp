// disturb's subcommands, one for each kind of event.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/common/event.hpp"
#include "services/runtime/cli.hpp"

namespace gyrotwin {

/// What the command line says of an event.
class EventOptions {
 public:
  /// Adds the subcommands to `command`, which must live as long as this object.
  explicit EventOptions(Command& command);
  EventOptions(const EventOptions&) = delete;
  EventOptions& operator=(const EventOptions&) = delete;

  /// The event whose subcommand was given, null when none was.
  /// @throws Error naming what is missing
  const AskedEvent* chosen();
  std::int64_t start_tick() const { return start_tick_; }     ///< 0: the next one
  std::optional<double> watch_s() const { return watch_s_; }  ///< [s]

 private:
  void add_quantity(Command& sub, const Quantity& quantity);
  void add_when(Command& sub, const EventKind& kind);

  Command& command_;
  AskedEvent event_;
  std::string which_;
  std::int64_t start_tick_ = 0;
  std::optional<double> watch_s_;
};

}  // namespace gyrotwin
