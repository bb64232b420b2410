// What an operator can make happen to a platform: disturbances and faults. One table names them
// and their numbers for the command line and for scenario files, and makes the requests.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "messages/channels.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

/// "N m" for people, `nm` at the end of a key.
struct Unit {
  std::string_view symbol, suffix;
};

/// One number of an event, or a flag.
struct Quantity {
  enum class Form : std::uint8_t { kNumber, kWhole, kFlag };
  enum class Need : std::uint8_t { kOptional, kRequired, kChoice };

  std::string_view name;  ///< "push_x"
  Unit unit;              ///< kTargetsUnit: the one of the sensor
  std::string_view what;  ///< for --help
  Range range;
  void (*set)(request_t& request, double value);  ///< a flag: 1
  Form form = Form::kNumber;
  Need need = Need::kOptional;
  std::optional<double> preset = {};  ///< what it is when nobody names it
};

/// Of a sensor's bias and noise.
inline constexpr Unit kTargetsUnit{"the sensor's unit", ""};

/// What an event happens to, where there is a choice.
struct Target {
  std::string_view name;  ///< "gyro", "0", "all"
  std::int32_t number;    ///< request_t.target
  Unit unit = {};         ///< of a sensor
};

/// One kind of event.
struct EventKind {
  enum class Choice : std::uint8_t { kNone, kAny, kOne };

  std::string_view name;     ///< subcommand of disturb, `kind` in a scenario file
  std::string_view summary;  ///< for --help
  std::int32_t verb, kind;   ///< request_t; kind 0: its quantities decide
  std::span<const Quantity> quantities;
  Choice choice = Choice::kNone;         ///< how many of those that are a choice must be there
  std::span<const Target> targets = {};  ///< empty: the whole platform
};

/// All of them, in the order of --help.
std::span<const EventKind> event_kinds();
/// The one with this name, null when there is none.
const EventKind* event_kind(std::string_view name);

/// What somebody said of an event.
struct AskedEvent {
  const EventKind* kind = nullptr;
  const Target* target = nullptr;  ///< null where the kind has none
  std::vector<std::pair<const Quantity*, double>> values{};

  bool has(const Quantity& quantity) const;
};

/// "--push-x".
std::string option_of(const Quantity& quantity);
/// "push_x_n"; a sensor's bias has the unit of its target.
std::string key_of(const Quantity& quantity, const Target* target);

/// Why the event is not one yet: what must be there and is not, or is there too often; empty when
/// nothing is wrong. Ranges are looked after where numbers are read.
/// @param spell names a quantity as its reader would write it
template <class Spell>
std::string shortcoming(const AskedEvent& event, Spell&& spell);

/// The request that causes the event, to act from the next tick on. An impulse without a direction
/// is the rig's reference push; it is exact however its duration is rounded to ticks.
/// @param tick_ns period of the owner's tick [ns], > 0
/// @pre shortcoming() has none
request_t request_of(const AskedEvent& event, const Rig& rig, std::int64_t tick_ns);

template <class Spell>
std::string shortcoming(const AskedEvent& event, Spell&& spell) {
  std::string choices;
  int chosen = 0;
  for (const Quantity& quantity : event.kind->quantities) {
    const bool given = event.has(quantity);
    if (quantity.need == Quantity::Need::kRequired && !given) {
      return std::string(event.kind->name) + ": " + spell(quantity) + " is missing";
    }
    if (quantity.need != Quantity::Need::kChoice) continue;
    choices += (choices.empty() ? "" : ", ") + spell(quantity);
    chosen += given ? 1 : 0;
  }
  const std::string kind(event.kind->name);
  switch (event.kind->choice) {
    case EventKind::Choice::kNone:
      break;
    case EventKind::Choice::kAny:
      if (chosen == 0) return kind + ": nothing was named; give at least one of " + choices;
      break;
    case EventKind::Choice::kOne:
      if (chosen != 1) return kind + ": give exactly one of " + choices;
      break;
  }
  return {};
}

}  // namespace gyrotwin
