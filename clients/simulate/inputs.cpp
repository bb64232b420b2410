#include "clients/simulate/inputs.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>

#include "clients/simulate/expression.hpp"
#include "clients/simulate/series.hpp"
#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

using Names = std::vector<std::string>;

constexpr std::size_t kMaxChannels = 6;  // a wrench has most
using Channels = std::array<double, kMaxChannels>;
static_assert(model::kMaxDrives <= kMaxChannels);

/// What an option sets.
struct Target {
  std::string option;
  Names channels;
  bool in_order;  // channels may go unnamed, then all are given in order
};

std::string list(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::optional<std::size_t> find(const Target& target, std::string_view name) {
  const auto it = std::find(target.channels.begin(), target.channels.end(), name);
  if (it == target.channels.end()) return std::nullopt;
  return static_cast<std::size_t>(it - target.channels.begin());
}

[[noreturn]] void unknown(const Target& target, const std::string& place, std::string_view name) {
  const std::vector<std::string_view> candidates(target.channels.begin(), target.channels.end());
  throw Error(place + ": unknown name `" + std::string(name) +
              "`; known: " + list(target.channels) + did_you_mean(nearest(name, candidates)));
}

bool is_table(const std::string& argument) {
  std::error_code none;
  const auto status = std::filesystem::status(argument, none);
  return argument.ends_with(".csv") ||
         (std::filesystem::exists(status) && !std::filesystem::is_directory(status));
}

/// Which channel each column sets.
std::vector<std::size_t> channels_of(const Series& series, const Target& target,
                                     const std::string& place) {
  std::vector<std::optional<std::size_t>> found;
  for (std::string_view name : series.columns()) {
    for (const std::string_view unit : {"_nm", "_n"}) {
      if (!find(target, name) && name.ends_with(unit)) name.remove_suffix(unit.size());
    }
    found.push_back(find(target, name));
  }
  const auto named = [](const auto& channel) { return channel.has_value(); };
  std::vector<std::size_t> channels;
  if (target.in_order && std::none_of(found.begin(), found.end(), named)) {
    if (found.size() != target.channels.size()) {
      throw Error(
          place + ": " + std::to_string(found.size()) +
          " columns beside the time, expected one for each drive: " + list(target.channels));
    }
    for (std::size_t i = 0; i < found.size(); ++i) channels.push_back(i);
    return channels;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) unknown(target, place, series.columns()[i]);
    if (std::find(channels.begin(), channels.end(), *found[i]) != channels.end()) {
      throw Error(place + ": two columns for " + target.channels[*found[i]]);
    }
    channels.push_back(*found[i]);
  }
  return channels;
}

InputFunction<Channels> table(const std::string& file, const Target& target) {
  const std::string place = target.option + ": " + file;
  Series series(read_file(file, place), place);
  std::vector<std::size_t> channels = channels_of(series, target, place);
  std::vector<double> times = series.times();
  return {[series = std::move(series), channels = std::move(channels)](const Instant& now) {
            Channels values{};
            const std::span<const double> row = series.at(now.within);
            for (std::size_t i = 0; i < row.size(); ++i) values[channels[i]] = row[i];
            return values;
          },
          std::move(times)};
}

struct Formula {
  std::size_t channel;
  Expression expression;
};

Formula formula(const std::string& argument, std::size_t index, const Target& target,
                const Names& variables) {
  const std::size_t equals = argument.find('=');
  std::size_t channel = index;
  std::string text = argument;
  if (equals != std::string::npos) {
    std::string name = argument.substr(0, equals);
    std::erase(name, ' ');
    const auto found = find(target, name);
    if (!found) unknown(target, target.option + ": column 1", name);
    channel = *found;
    std::fill_n(text.begin(), equals + 1, ' ');  // columns in messages stay right
  }
  try {
    return {channel, Expression(text, variables)};
  } catch (const Error& error) {
    throw Error(target.option + ": " + error.what());
  }
}

/// Either every formula has a name or, where the option allows it, none and all are there.
void check_names(const Names& arguments, const Target& target) {
  const auto named = std::count_if(arguments.begin(), arguments.end(), [](const auto& argument) {
    return argument.find('=') != std::string::npos;
  });
  if (named == std::ssize(arguments)) return;
  const bool complete = named == 0 && arguments.size() == target.channels.size();
  if (target.in_order && complete) return;
  throw Error(target.option + ": " +
              (named == 0 ? std::to_string(arguments.size()) + " without a name"
                          : std::string("some with a name and some without")) +
              "; " +
              (target.in_order ? "give one for each drive in this order, or name them"
                               : "name them, or give a CSV file") +
              ": `" + target.option + " " + target.channels[0] +
              "=FORMULA`; names: " + list(target.channels));
}

InputFunction<Channels> formulas(const Names& arguments, const Target& target,
                                 const model::Machine& machine) {
  Names variables = state_columns(machine);
  variables.insert(variables.begin(), "t");
  check_names(arguments, target);
  std::vector<Formula> all;
  for (const std::string& argument : arguments) {
    Formula next = formula(argument, all.size(), target, variables);
    if (std::any_of(all.begin(), all.end(), [&](auto& f) { return f.channel == next.channel; })) {
      throw Error(target.option + ": " + target.channels[next.channel] + " is given twice");
    }
    all.push_back(std::move(next));
  }
  const int n = machine.coordinates();
  return {[all = std::move(all), n](const Instant& now) {
            std::array<double, 1 + 2 * model::kMaxCoordinates> values;
            values[0] = now.t;
            std::copy_n(now.state.q.data(), n, values.data() + 1);
            std::copy_n(now.state.v.data(), n, values.data() + 1 + n);
            Channels result{};
            for (const Formula& f : all) result[f.channel] = f.expression(values);
            return result;
          },
          {}};
}

InputFunction<Channels> input(const Names& arguments, const Target& target,
                              const model::Machine& machine) {
  if (std::none_of(arguments.begin(), arguments.end(), is_table)) {
    return formulas(arguments, target, machine);
  }
  if (arguments.size() == 1) return table(arguments[0], target);
  throw Error(target.option + ": a CSV file stands alone, but there are " +
              std::to_string(arguments.size()) + "; put everything into one file");
}

}  // namespace

InputFunction<DriveTorques> torque_input(const Names& arguments, const model::Machine& machine) {
  Target target{"--torque", {}, true};
  for (const model::Drive& drive : machine.drives) {
    target.channels.push_back(machine.layout.names[static_cast<std::size_t>(drive.coordinate)]);
  }
  InputFunction<Channels> channels = input(arguments, target, machine);
  return {[value = std::move(channels.value)](const Instant& now) {
            const Channels c = value(now);
            DriveTorques torques{};
            std::copy_n(c.begin(), torques.size(), torques.begin());
            return torques;
          },
          std::move(channels.breakpoints)};
}

InputFunction<Wrench> external_input(const Names& arguments, const model::Machine& machine) {
  if (arguments.empty()) return {};
  const Target target{"--external", {"fx", "fy", "fz", "mx", "my", "mz"}, false};
  InputFunction<Channels> channels = input(arguments, target, machine);
  return {[value = std::move(channels.value)](const Instant& now) {
            const Channels c = value(now);
            return Wrench{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
          },
          std::move(channels.breakpoints)};
}

std::vector<std::string> state_columns(const model::Machine& machine) {
  Names columns = machine.layout.names;
  for (const std::string& name : machine.layout.names) columns.push_back(name + "_dot");
  return columns;
}

}  // namespace gyrotwin
