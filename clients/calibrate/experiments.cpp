#include "clients/calibrate/experiments.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

enum Machine : unsigned { kUmbrella = 1, kGimballed = 2, kGyroscope = 4 };

/// Which experiment tells a key, on which machines it is asked for by default.
struct Entry {
  std::string_view key;
  std::string_view experiment;
  unsigned by_default;
};

constexpr std::array kEntries{
    Entry{"disc.inertia_polar_kgm2", "coast-down", kUmbrella},
    Entry{"disc.viscous_friction_nms_per_rad", "coast-down", kUmbrella},
    Entry{"disc.coulomb_friction_nm", "coast-down", kUmbrella},
    Entry{"drive.motor_inertia_kgm2", "coast-down", 0},
    Entry{"drive.torque_constant_nm_per_a", "coast-down", 0},
    Entry{"gyroscope.post_damping_nms_per_rad", "coast-down", kGyroscope},
    Entry{"gyroscope.post_inertia_kgm2", "coast-down", kGyroscope},
    Entry{"structure.inertia_x_kgm2", "swing", kUmbrella},
    Entry{"structure.inertia_y_kgm2", "swing", 0},
    Entry{"structure.inertia_tilt_kgm2", "swing", kGimballed},
    Entry{"structure.cm_height_m", "swing", kUmbrella | kGimballed},
    Entry{"structure.mass_kg", "swing", 0},
    Entry{"structure.damping_nms_per_rad", "swing", kUmbrella | kGimballed},
    Entry{"rotor_drive.viscous_drag_nms_per_rad", "run-down", kUmbrella | kGimballed | kGyroscope},
    Entry{"rotor_drive.coulomb_drag_nm", "run-down", kUmbrella | kGimballed | kGyroscope},
    Entry{"gyros.rotor_inertia_kgm2", "free-run", kUmbrella | kGimballed},
    Entry{"gyroscope.rotor_inertia_kgm2", "free-run", kGyroscope},
    Entry{"gyros.damping_nms_per_rad", "free-run", kGimballed},
    Entry{"gyros.inertia_transverse_kgm2", "free-run", 0},
    Entry{"contact.stiffness_n_per_m1_5", "free-run", kUmbrella},
    Entry{"contact.damping_s_per_m", "free-run", 0},
};

constexpr std::array<unsigned, 3> kMachines{kUmbrella, kGimballed, kGyroscope};  // as Rig::machine

}  // namespace

const ExperimentKind& experiment_of(std::string_view name) {
  const auto* const found = std::ranges::find(kExperiments, name, &ExperimentKind::name);
  if (found != kExperiments.end()) return *found;
  std::array<std::string_view, kExperiments.size()> names;
  std::ranges::transform(kExperiments, names.begin(), &ExperimentKind::name);
  throw Error(
      fmt::format("there is no experiment `{}`{}", name, did_you_mean(nearest(name, names))));
}

double watched_s(const ExperimentKind& kind, const Rig& rig) {
  constexpr double kUsual = 10.0, kLongest = 1800.0;
  if (kind.name != "run-down" || !rig.rotor_drive) return kUsual;
  const auto [inertia, speed] = std::visit(
      [](const auto& machine) -> std::pair<double, double> {
        if constexpr (requires { machine.gyros; }) {
          return {machine.gyros.rotor_inertia, std::abs(machine.gyros.rotor_speed)};
        } else {
          return {machine.gyro.rotor_inertia, std::abs(machine.gyro.rotor_speed)};
        }
      },
      rig.machine);
  // I n' = -(b n + c), from n to n/2.
  const double b = rig.rotor_drive->viscous_drag, c = rig.rotor_drive->coulomb_drag;
  const double half = b > 0.0 ? inertia / b * std::log((b * speed + c) / (0.5 * b * speed + c))
                              : 0.5 * inertia * speed / c;
  return std::isfinite(half) ? std::clamp(std::ceil(half), kUsual, kLongest) : kUsual;
}

std::vector<std::string> keys_of(const ExperimentKind& kind, const Rig& rig) {
  const unsigned machine = kMachines[rig.machine.index()];
  std::vector<std::string> keys;
  for (const Entry& entry : kEntries) {
    if (entry.experiment != kind.name || (entry.by_default & machine) == 0) continue;
    if (entry.key.starts_with("rotor_drive") && !rig.rotor_drive) continue;
    keys.emplace_back(entry.key);
  }
  return keys;
}

std::vector<std::string> arrangement(const ExperimentKind& kind, const Rig& rig) {
  std::vector<std::string> overrides;
  const auto pin = [&](const char* key) { overrides.push_back(fmt::format("{}=1e9", key)); };
  if (std::holds_alternative<model::UmbrellaParameters>(rig.machine)) {
    if (kind.structure_pinned) pin("structure.inertia_x_kgm2");
    if (kind.structure_pinned) pin("structure.inertia_y_kgm2");
    if (kind.disc_pinned) pin("disc.inertia_polar_kgm2");
    if (kind.axles_lifted) overrides.emplace_back("umbrella.track=none");
    // Tied gyros, as far as a solver without stiffness goes: they creep back within a millisecond.
    if (kind.axles_lifted && !kind.disc_pinned) {
      overrides.emplace_back("gyros.damping_nms_per_rad=10");
    }
  } else if (std::holds_alternative<model::GimballedParameters>(rig.machine)) {
    if (kind.structure_pinned) pin("structure.inertia_tilt_kgm2");
  } else if (kind.disc_pinned) {
    pin("gyroscope.post_inertia_kgm2");
  }
  return overrides;
}

const ExperimentKind* best_for(std::string_view key) {
  const auto* const entry = std::ranges::find(kEntries, key, &Entry::key);
  return entry == kEntries.end() ? nullptr : &experiment_of(entry->experiment);
}

}  // namespace gyrotwin
