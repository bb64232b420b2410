#include "clients/disturb/options.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "services/runtime/cli.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

constexpr double kLatest = 1e15;     // [tick]
constexpr double kLongest = 3600.0;  // [s]

/// What the quantity takes; its unit in --help says enough.
CLI::Validator within(const Quantity& quantity) {
  return {[&quantity](std::string& text) {
            const bool whole = quantity.form == Quantity::Form::kWhole;
            double x = 0.0;
            const bool right = CLI::detail::lexical_cast(text, x) && quantity.range.contains(x) &&
                               (!whole || x == std::round(x));
            return right ? std::string()
                         : fmt::format("`{}` is no {}number{}", text, whole ? "whole " : "",
                                       quantity.range.text());
          },
          ""};
}

std::string help_of(const Quantity& quantity) {
  std::string help(quantity.what);
  if (!quantity.unit.symbol.empty()) help += fmt::format(" [{}]", quantity.unit.symbol);
  if (quantity.preset) help += fmt::format("; default {:g}", *quantity.preset);
  return help;
}

}  // namespace

EventOptions::EventOptions(CLI::App& app) {
  for (const EventKind& kind : event_kinds()) {
    CLI::App* sub = app.add_subcommand(std::string(kind.name), std::string(kind.summary));
    sub->parse_complete_callback([this, &kind] { event_.kind = &kind; });
    if (!kind.targets.empty()) add_target(*sub, kind);
    for (const Quantity& quantity : kind.quantities) add_quantity(*sub, quantity);
    add_when(*sub, kind);
  }
}

void EventOptions::add_target(CLI::App& sub, const EventKind& kind) {
  std::vector<std::string_view> names;
  for (const Target& target : kind.targets) names.push_back(target.name);
  sub.add_option_function<std::string>(
         "which",
         [this, &kind, names](const std::string& word) {
           const auto found = std::ranges::find(kind.targets, word, &Target::name);
           if (found == kind.targets.end()) {
             throw Error(fmt::format("{}: there is no `{}`; expected one of {}{}", kind.name, word,
                                     fmt::join(names, ", "), did_you_mean(nearest(word, names))));
           }
           event_.target = &*found;
         },
         fmt::format("{}", fmt::join(names, ", ")))
      ->required()
      ->type_name("NAME");
}

void EventOptions::add_quantity(CLI::App& sub, const Quantity& quantity) {
  const auto take = [this, &quantity](double value) {
    event_.values.emplace_back(&quantity, value);
  };
  if (quantity.form == Quantity::Form::kFlag) {
    sub.add_flag_callback(
        option_of(quantity), [take] { take(1.0); }, help_of(quantity));
    return;
  }
  sub.add_option_function<double>(option_of(quantity), take, help_of(quantity))
      ->required(quantity.need == Quantity::Need::kRequired)
      ->type_name(quantity.form == Quantity::Form::kWhole ? "N" : "X")
      ->check(within(quantity));
}

void EventOptions::add_when(CLI::App& sub, const EventKind& kind) {
  sub.add_option("--at-tick", start_tick_, "First tick it acts in; default: the next one")
      ->type_name("N")
      ->check(finite_within(1.0, kLatest).description(""))
      ->group("When");
  const std::string by_itself = kind.name == "impulse" ? "; default: 3 on a terminal" : "";
  sub.add_option("--watch", watch_s_, "Watch the tilt for so long [s]" + by_itself)
      ->type_name("S")
      ->check(finite_within(0.0, kLongest).description(""))
      ->group("When");
}

const AskedEvent* EventOptions::chosen() const {
  if (event_.kind == nullptr) return nullptr;
  const std::string missing = shortcoming(event_, option_of);
  if (!missing.empty()) throw Error(missing);
  return &event_;
}

}  // namespace gyrotwin
