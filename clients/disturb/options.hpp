// disturb's subcommands, one for each kind of event.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/common/event.hpp"
#include "services/runtime/cli.hpp"

namespace gyrotwin {

/// What the command line says of an event.
class EventOptions {
 public:
  /// Adds the subcommands. CommandLine::run() writes to this object.
  explicit EventOptions(Command command);
  EventOptions(const EventOptions&) = delete;
  EventOptions& operator=(const EventOptions&) = delete;

  /// The event whose subcommand was given, if one was.
  /// @throws Error naming what is missing
  std::optional<AskedEvent> chosen() const;
  std::int64_t start_tick() const { return start_tick_; }     ///< 0: the next one
  std::optional<double> watch_s() const { return watch_s_; }  ///< [s]

 private:
  void add_quantity(Command& sub, const Quantity& quantity);
  void add_when(Command& sub, const EventKind& kind);

  Command command_;
  std::string target_;
  std::vector<std::pair<const Quantity*, double>> values_;
  std::int64_t start_tick_ = 0;
  std::optional<double> watch_s_;
};

}  // namespace gyrotwin
