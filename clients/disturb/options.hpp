// disturb's subcommands, one for each kind of event.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "clients/common/event.hpp"

namespace gyrotwin {

/// What the command line says of an event.
class EventOptions {
 public:
  /// Adds the subcommands to `app`, which must live as long as this object.
  explicit EventOptions(CLI::App& app);
  EventOptions(const EventOptions&) = delete;
  EventOptions& operator=(const EventOptions&) = delete;

  /// The event whose subcommand was given, null when none was.
  /// @throws Error naming what is missing
  const AskedEvent* chosen() const;
  std::int64_t start_tick() const { return start_tick_; }     ///< 0: the next one
  std::optional<double> watch_s() const { return watch_s_; }  ///< [s]

 private:
  void add_target(CLI::App& sub, const EventKind& kind);
  void add_quantity(CLI::App& sub, const Quantity& quantity);
  void add_when(CLI::App& sub, const EventKind& kind);

  AskedEvent event_;
  std::int64_t start_tick_ = 0;
  std::optional<double> watch_s_;
};

}  // namespace gyrotwin
