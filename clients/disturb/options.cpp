#include "clients/disturb/options.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::int64_t kLatest = 1'000'000'000'000'000;  // [tick]
constexpr double kLongest = 3600.0;                      // [s]

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

}  // namespace

EventOptions::EventOptions(Command command) : command_(command) {
  for (const EventKind& kind : event_kinds()) {
    Command sub = command_.add_subcommand(kind.name, kind.summary);
    if (!kind.targets.empty()) {
      sub.add_option("target", target_, "What it happens to")
          .required()
          .type("TARGET")
          .check(one_of(names_of(kind.targets)));
    }
    for (const Quantity& quantity : kind.quantities) add_quantity(sub, quantity);
    add_when(sub, kind);
  }
}

void EventOptions::add_quantity(Command& sub, const Quantity& quantity) {
  const auto take = [this, &quantity](double value) { values_.emplace_back(&quantity, value); };
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
      .check(whole_within(1, kLatest).untold())
      .group("When");
  const std::string by_itself = kind.name == "impulse" ? "; default: 3 on a terminal" : "";
  sub.add_option("--watch", watch_s_, "Watch the tilt for so long [s]" + by_itself)
      .type("S")
      .check(number_within(0.0, kLongest).untold())
      .group("When");
}

std::optional<AskedEvent> EventOptions::chosen() const {
  AskedEvent event{.kind = event_kind(command_.given_subcommand()), .values = values_};
  if (event.kind == nullptr) return std::nullopt;
  if (!event.kind->targets.empty()) {
    event.target = &*std::ranges::find(event.kind->targets, target_, &Target::name);
  }
  const std::string missing = shortcoming(event, option_of);
  if (!missing.empty()) throw Error(missing);
  return event;
}

}  // namespace gyrotwin
