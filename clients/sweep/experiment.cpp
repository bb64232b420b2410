#include "clients/sweep/experiment.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>

#include "clients/common/initial.hpp"
#include "clients/common/shell_word.hpp"
#include "clients/simulate/stepper_word.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::string_view kStart = "start.";

bool is_start(const std::string& key) { return key.starts_with(kStart); }
bool is_event(const std::string& key) {
  return key.starts_with("event") && key.size() > 5 && key[5] >= '0' && key[5] <= '9';
}

std::optional<double> number_at(const toml::node_view<const toml::node>& node) {
  return node.is_number() ? node.value<double>() : std::nullopt;
}

/// The number that a document has under `table.key` or `eventN.key`.
std::optional<double> number_in(const toml::table& document, const std::string& path) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) return std::nullopt;
  const std::string key = path.substr(dot + 1);
  if (!is_event(path)) return number_at(document[path.substr(0, dot)][key]);
  const std::size_t number = std::stoul(path.substr(5, dot - 5));
  return number_at(document["event"][number - 1][key]);
}

model::State start_of(const Rig& rig, const model::Machine& machine,
                      const std::vector<std::string>& settings) {
  Initial initial{rig.initial_q, rig.initial_v};
  for (const std::string& setting : settings) {
    initial = parse_initial(setting, machine.layout.names, std::move(initial));
  }
  model::State state = rig.initial_state(machine);
  const model::State said = machine.state(initial.q, initial.v);
  state.q = said.q;
  state.v = said.v;
  return state;
}

std::string verdict_of(const Trial& trial) {
  if (trial.outcome.verdict.fell_at()) return "falls";
  if (!trial.stood()) return "failed";
  if (trial.outcome.verdict.leans()) return "leans";
  return trial.outcome.verdict.growing() ? "growing" : "stands";
}

/// What is varied is set for each run; who hears of it said --vary.
std::string in_words_of(const Plan& plan, std::string text) {
  for (const Variable& variable : plan.variables) {
    const std::string set = "--set " + variable.key + ':';
    const std::size_t at = text.find(set);
    if (at != std::string::npos) text.replace(at, set.size(), "--vary " + variable.key + ':');
  }
  return text;
}

std::string cell(double value) { return std::isfinite(value) ? number_text(value) : ""; }

}  // namespace

Experiment::Experiment(Bench bench, Plan plan) : bench_(std::move(bench)), plan_(std::move(plan)) {
  for (const Variable& variable : plan_.variables) {
    if (is_event(variable.key) && bench_.scenario.document.empty()) {
      throw Error(variable.key + ": there are no events without --scenario");
    }
    if (is_start(variable.key) && variable.words) {
      throw Error(
          fmt::format("{}={}: an initial state takes numbers", variable.key, variable.spec));
    }
    if (!variable.factor) continue;
    const std::string text =
        is_event(variable.key) ? bench_.scenario.document : print_rig(bench_.rig, bench_.overrides);
    const auto base =
        is_start(variable.key) ? std::nullopt : number_in(toml::parse(text), variable.key);
    if (!base) {
      throw Error(fmt::format("{}={}: there is no number to multiply; leave out the *",
                              variable.key, variable.spec));
    }
    base_[variable.key] = *base;
  }
  check();
}

void Experiment::check() const {
  constexpr std::int64_t kLooks = 50;
  std::string first;
  for (std::int64_t run = 0; run < std::min(kLooks, plan_.runs()); ++run) {
    const std::string why = refusal(run);
    if (why.empty()) return;
    if (first.empty()) first = why;
  }
  throw Error(first);
}

std::vector<Scenario::Event> Experiment::events_of(const Rig& rig,
                                                   const std::vector<std::string>& settings) const {
  std::vector<Scenario::Event> events;
  if (bench_.scenario.document.empty()) return events;
  for (const PlannedEvent& planned :
       read_scenario(bench_.scenario.document, bench_.scenario.source, settings)) {
    events.push_back({request_of(planned, rig, rig.loop.tick_ns(), 0), planned.place});
  }
  return events;
}

std::string Experiment::header() const {
  std::string text = "run";
  for (const Variable& variable : plan_.variables) text += ',' + variable.key;
  return text +
         ",verdict,fell_at_s,largest_tilt_rad,end_tilt_rad,least_gimbal_margin_rad,"
         "largest_torque_nm,largest_holding_moment_nm\n";
}

Point Experiment::values(std::int64_t run) const {
  Point point = plan_.point(run);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Variable& variable = plan_.variables[i];
    if (variable.factor) point[i] = number_text(base_.at(variable.key) * std::stod(point[i]));
    if (variable.kind == Variable::Kind::kSeed) {
      point[i] = fmt::format("{:.0f}", std::stod(point[i]));
    }
  }
  return point;
}

Experiment::Settings Experiment::settings(const Point& values) const {
  Settings settings{bench_.overrides, {}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string text = plan_.variables[i].key + '=' + values[i];
    if (is_start(text)) {
      settings.start.push_back(text.substr(kStart.size()));
    } else {
      (is_event(text) ? settings.events : settings.rig).push_back(text);
    }
  }
  return settings;
}

const Experiment::Built& Experiment::built(const std::vector<std::string>& settings) const {
  if (!built_ || built_->settings != settings) {
    const Rig rig = load_rig(bench_.rig, settings);
    built_ = Built{settings, rig, rig.build_machine()};
  }
  return *built_;
}

Trial Experiment::trial(const Settings& settings) const {
  const auto& [_, rig, machine] = built(settings.rig);
  Scenario scenario = live_scenario(rig, machine, bench_.duration);
  scenario.start = start_of(rig, machine, settings.start);
  scenario.events = events_of(rig, settings.events);
  scenario.stepping.kind = bench_.stepper;
  return run_trial(rig, machine, scenario);
}

std::string Experiment::line(std::int64_t run) const {
  const Point point = values(run);
  std::string text = fmt::format("{},{}", run, fmt::join(point, ","));
  try {
    const Trial seen = trial(settings(point));
    const auto fell = seen.outcome.verdict.fell_at();
    const bool tilts = seen.outcome.verdict.has_tilt();
    return text + fmt::format(",{},{},{},{},{},{},{}\n", verdict_of(seen),
                              fell ? number_text(*fell) : "", tilts ? cell(seen.largest_tilt) : "",
                              tilts ? cell(seen.end_tilt) : "", cell(seen.least_gimbal_margin),
                              cell(seen.largest_torque), cell(seen.largest_holding_moment));
  } catch (const Error&) {
    return text + ",impossible,,,,,,\n";
  }
}

std::string Experiment::refusal(std::int64_t run) const {
  try {
    const Settings chosen = settings(values(run));
    const auto& [_, rig, machine] = built(chosen.rig);
    start_of(rig, machine, chosen.start);
    events_of(rig, chosen.events);
  } catch (const Error& error) {
    return in_words_of(plan_, error.what());
  }
  return "";
}

double Experiment::duration_of(const Settings& settings) const {
  try {
    const auto& [_, rig, machine] = built(settings.rig);
    return live_scenario(rig, machine, bench_.duration).duration;
  } catch (const Error&) {
    return bench_.duration;  // there is no such rig, which is what the command will say
  }
}

std::string Experiment::repeat_command(std::int64_t run) const {
  const Settings chosen = settings(values(run));
  std::string text = "gyrotwin simulate --rig " + shell_word(bench_.rig);
  for (const std::string& setting : chosen.rig) text += " --set " + shell_word(setting);
  if (!chosen.start.empty()) {
    text += " --initial " + shell_word(fmt::format("{}", fmt::join(chosen.start, ",")));
  }
  if (!bench_.scenario.source.empty()) {
    text += " --scenario " + shell_word(bench_.scenario.source);
    for (const std::string& event : chosen.events) text += " --event " + shell_word(event);
  }
  return text + " --feedback sampled --stepper " + word_of(bench_.stepper) + " --duration " +
         number_text(duration_of(chosen));
}

}  // namespace gyrotwin
