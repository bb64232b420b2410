#include "clients/disturb/options.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

constexpr double kLatest = 1e15;     // [tick]
constexpr double kLongest = 3600.0;  // [s]

/// What the quantity takes; its unit in --help says enough.
Check within(const Quantity& quantity) {
  const bool whole = quantity.form == Quantity::Form::kWhole;
  return number(
      [&quantity, whole](double x) {
        return quantity.range.contains(x) && (!whole || x == std::round(x));
      },
      (whole ? "whole number" : "number") + quantity.range.text());
}

std::string help_of(const Quantity& quantity) {
  std::string help(quantity.what);
  if (!quantity.unit.symbol.empty()) help += fmt::format(" [{}]", quantity.unit.symbol);
  if (quantity.preset) help += fmt::format("; default {:g}", *quantity.preset);
  return help;
}

std::string list(std::span<const Target> targets) {
  std::string text;
  for (const Target& target : targets) {
    text += (text.empty() ? "" : ", ") + std::string(target.name);
  }
  return text;
}

/// @throws Error when the kind has no such target
const Target* target_of(const EventKind& kind, const std::string& word) {
  const auto found = std::ranges::find(kind.targets, word, &Target::name);
  if (found != kind.targets.end()) return &*found;
  std::vector<std::string_view> names;
  for (const Target& target : kind.targets) names.push_back(target.name);
  throw Error(fmt::format("{}: there is no `{}`; expected one of {}{}", kind.name, word,
                          list(kind.targets), did_you_mean(nearest(word, names))));
}

}  // namespace

EventOptions::EventOptions(Command& command) : command_(command) {
  for (const EventKind& kind : event_kinds()) {
    Command sub = command.add_subcommand(kind.name, kind.summary);
    if (!kind.targets.empty()) {
      sub.add_option("which", which_, list(kind.targets)).required().type("NAME");
    }
    for (const Quantity& quantity : kind.quantities) add_quantity(sub, quantity);
    add_when(sub, kind);
  }
}

void EventOptions::add_quantity(Command& sub, const Quantity& quantity) {
  const auto take = [this, &quantity](double value) {
    event_.values.emplace_back(&quantity, value);
  };
  if (quantity.form == Quantity::Form::kFlag) {
    sub.add_flag(
        option_of(quantity), [take] { take(1.0); }, help_of(quantity));
    return;
  }
  sub.add_number(option_of(quantity), take, help_of(quantity))
      .required(quantity.need == Quantity::Need::kRequired)
      .type(quantity.form == Quantity::Form::kWhole ? "N" : "X")
      .check(within(quantity));
}

void EventOptions::add_when(Command& sub, const EventKind& kind) {
  sub.add_option("--at-tick", start_tick_, "First tick it acts in; default: the next one")
      .type("N")
      .check(whole_within(1.0, kLatest).untold())
      .group("When");
  const std::string by_itself = kind.name == "impulse" ? "; default: 3 on a terminal" : "";
  sub.add_option("--watch", watch_s_, "Watch the tilt for so long [s]" + by_itself)
      .type("S")
      .check(number_within(0.0, kLongest).untold())
      .group("When");
}

const AskedEvent* EventOptions::chosen() {
  event_.kind = event_kind(command_.given_subcommand());
  if (event_.kind == nullptr) return nullptr;
  if (!which_.empty()) event_.target = target_of(*event_.kind, which_);
  const std::string missing = shortcoming(event_, option_of);
  if (!missing.empty()) throw Error(missing);
  return &event_;
}

}  // namespace gyrotwin
