#include "clients/calibrate/family.hpp"

#include <spdlog/fmt/fmt.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/runtime/error.hpp"
#include "services/runtime/rig_reader.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr std::array<std::string_view, 9> kTables{"structure", "disc",      "gyros",
                                                  "contact",   "bushing",   "drive",
                                                  "load_cell", "gyroscope", "rotor_drive"};
// Of the machine, and not to be found in a log: counts, limits of drives and what is commanded.
constexpr std::array<std::string_view, 6> kNotSought{
    "gyros.count",           "gyros.rotor_speed_rad_s", "gyroscope.rotor_speed_rad_s",
    "drive.torque_limit_nm", "rotor_drive.start_share", "drive.supply_voltage_v"};

std::string table_of(const std::string& key) { return key.substr(0, key.find('.')); }

bool makes_the_machine(const std::string& key) {
  return std::ranges::find(kTables, table_of(key)) != kTables.end() &&
         std::ranges::find(kNotSought, key) == kNotSought.end();
}

/// @throws Error naming what was likely meant
void require_key(const std::string& key, const toml::table& document) {
  const std::size_t dot = key.find('.');
  const auto node = dot == std::string::npos ? toml::node_view<const toml::node>()
                                             : document[key.substr(0, dot)][key.substr(dot + 1)];
  if (node.is_number() && makes_the_machine(key)) return;
  std::vector<std::string> known;
  for (const auto& [table, keys] : document) {
    if (!keys.is_table()) continue;
    for (const auto& [name, value] : *keys.as_table()) {
      std::string path = std::string(table.str()) + '.' + std::string(name.str());
      if (value.is_number() && makes_the_machine(path)) known.push_back(std::move(path));
    }
  }
  const std::vector<std::string_view> names(known.begin(), known.end());
  throw Error(fmt::format("--fit {}: is no number of this rig's machine{}", key,
                          did_you_mean(nearest(key, names))));
}

std::string setting(const Parameter& parameter, double x) {
  return fmt::format("{}={:.17e}", parameter.key, parameter.value(x));
}

}  // namespace

Family::Family(std::string rig, std::vector<std::string> overrides,
               const std::vector<std::string>& keys)
    : rig_(std::move(rig)), overrides_(std::move(overrides)) {
  const toml::table document = toml::parse(print_rig(rig_, overrides_));
  for (const std::string& key : keys) {
    require_key(key, document);
    const std::size_t dot = key.find('.');
    const double start = *document[key.substr(0, dot)][key.substr(dot + 1)].value<double>();
    if (start == 0.0) {
      throw Error(
          fmt::format("--fit {0}: is 0 in the rig file; give a guess to start from, "
                      "--set {0}=...",
                      key));
    }
    parameters_.push_back({key, start, std::abs(start)});
    rotors_run_ |= table_of(key) == "rotor_drive";
  }
}

Rig Family::rig_at(std::span<const double> x) const {
  std::vector<std::string> overrides = overrides_;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    overrides.push_back(setting(parameters_[i], x[i]));
  }
  return load_rig(rig_, overrides);
}

model::Machine Family::machine_at(std::span<const double> x) const {
  model::Machine machine = rig_at(x).build_machine();
  if (!rotors_run_) machine.rotor_drive.reset();
  machine.unheld.reset();  // tells the holding moment, which is not asked for here
  return machine;
}

Neighbourhood Family::around(std::span<const double> x) const {
  Neighbourhood all{machine_at(x), {}};
  std::vector<double> moved(x.begin(), x.end());
  const auto beside = [&](std::size_t i, double step) {
    moved[i] = x[i] + step;
    std::optional<model::Machine> machine;
    try {
      machine = machine_at(moved);
    } catch (const Error&) {
      // The edge of what is a rig at all: the difference is taken on the other side alone.
    }
    moved[i] = x[i];
    return machine;
  };
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const auto up = beside(i, Neighbourhood::kStep);
    const auto down = beside(i, -Neighbourhood::kStep);
    const int sides = (up ? 1 : 0) + (down ? 1 : 0);
    if (sides == 0) throw Error(parameters_[i].key + ": there is no rig beside this one");
    all.pairs.push_back(
        {up.value_or(all.machine), down.value_or(all.machine), Neighbourhood::kStep * sides});
  }
  return all;
}

}  // namespace gyrotwin::calibration
