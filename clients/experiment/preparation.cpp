#include "clients/experiment/preparation.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <variant>

#include "clients/common/shell_word.hpp"
#include "services/integrator/plant.hpp"

namespace gyrotwin {

namespace {

constexpr double kImmovable = 1e6;   // inertia of a pinned structure, at least [kg m^2]
constexpr int kMostSubsteps = 1000;  // of a rig file

/// Whether the rig file has what a simulated rig needs for it.
bool is_arranged(const ExperimentKind& kind, const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    const auto& s = umbrella->structure;
    return (!kind.structure_pinned || std::min(s.inertia_x, s.inertia_y) > kImmovable) &&
           (!kind.disc_pinned || umbrella->disc.inertia_polar > kImmovable) &&
           (!kind.axles_lifted || umbrella->track == model::TrackKind::kNone);
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return !kind.structure_pinned || gimballed->structure.inertia_tilt > kImmovable;
  }
  const auto& gyro = std::get<model::GyroscopeParameters>(rig.machine).gyro;
  return !kind.disc_pinned || gyro.post_inertia > kImmovable;
}

/// Toppling stiffness without counterweight [N m/rad].
double toppling(const Rig& rig) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    return model::reduce(*umbrella).U;
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return model::reduce(*gimballed).U;
  }
  return 0.0;
}

/// The key of a `key=value` override.
std::string_view key_of(std::string_view override) {
  return override.substr(0, override.find('='));
}

/// Overrides as words, of which the later ones count.
std::string as_words(const std::vector<std::string>& earlier,
                     const std::vector<std::string>& later) {
  std::string text;
  for (const std::string& word : earlier) {
    if (std::ranges::find(later, key_of(word), key_of) == later.end()) {
      text += " --set " + shell_word(word);
    }
  }
  for (const std::string& word : later) text += " --set " + shell_word(word);
  return text;
}

/// What the integrator's step check asks for besides, of a rig with these overrides; or nothing.
std::vector<std::string> finer_steps(const Rig& rig, const std::vector<std::string>& overrides) {
  Rig arranged = load_rig(rig.file.string(), overrides);
  const model::Machine machine = arranged.build_machine();
  const int filed = arranged.loop.substeps;
  while (stepping_error(arranged, machine) > arranged.loop.step_tolerance) {
    arranged.loop.substeps *= 2;
    if (arranged.loop.substeps > kMostSubsteps) return {};  // the integrator says why
  }
  if (arranged.loop.substeps == filed) return {};
  return {fmt::format("loop.substeps={}", arranged.loop.substeps)};
}

/// Why the drives must let go in a safe stop; empty: as the rig file has it will do.
std::string unfit_safe_stop(const ExperimentPlan& plan, const Rig& rig) {
  if (rig.safety.drive == SafeStopDrive::kHoldSpeed) {
    return "safety.safe_stop is hold_speed, whose torque no log tells";
  }
  const bool has_disc = std::holds_alternative<model::UmbrellaParameters>(rig.machine);
  if (has_disc && is_named(plan, "coast-down") && rig.safety.drive != SafeStopDrive::kZeroTorque) {
    return "the disc must coast once it is disarmed";
  }
  return {};
}

/// What owner, controller and experiment are to be started with; empty: as they are.
std::string misarranged(const ExperimentPlan& plan, const Rig& rig, bool simulated,
                        const std::vector<std::string>& given) {
  std::vector<std::string> missing, reasons;
  if (simulated) {
    if (!is_arranged(*plan.kind, rig)) missing = arrangement(*plan.kind, rig);
    if (plan.kind->rotors_at_rest && rig.rotor_drive && rig.initial_rotor_share > 0.0) {
      missing.emplace_back("rotor_drive.start_share=0");
    }
    if (!missing.empty()) reasons.emplace_back("a simulated rig has no hands to arrange it");
  }
  const std::string unfit_stop = unfit_safe_stop(plan, rig);
  if (!unfit_stop.empty()) {
    reasons.push_back(unfit_stop);
    missing.emplace_back("safety.safe_stop=zero_torque");
  }
  if (missing.empty()) return {};
  if (simulated) {
    std::vector<std::string> all = given;
    std::ranges::copy(missing, std::back_inserter(all));
    std::ranges::copy(finer_steps(rig, all), std::back_inserter(missing));
  }
  return fmt::format("{}: start owner, controller and this with{}", fmt::join(reasons, "; "),
                     as_words(given, missing));
}

}  // namespace

bool is_named(const ExperimentPlan& plan, std::string_view name) { return plan.kind->name == name; }

std::string misfit(const ExperimentPlan& plan, const Rig& rig, bool simulated,
                   const std::vector<std::string>& given) {
  if (!rig.sensors) return "the rig file has no [sensors]: nothing would be measured";
  if (is_named(plan, "run-down") && !rig.rotor_drive) {
    return "the rig file has no [rotor_drive]: its rotors keep their speed";
  }
  if (is_named(plan, "swing") && rig.machine.index() == 2) {
    return "this rig stands on a post and cannot swing";
  }
  if (keys_of(*plan.kind, rig).empty()) {
    return fmt::format("a {} tells nothing of such a machine", plan.kind->name);
  }
  std::string why = misarranged(plan, rig, simulated, given);
  if (!why.empty()) return why;
  if (!is_named(plan, "swing")) return {};
  const double restoring = -model::kGravity * plan.mass_kg * plan.mass_height_m - toppling(rig);
  if (restoring <= 0.0) {
    return fmt::format(
        "it would not swing but fall: by the rig file the counterweight must give "
        "more than {:.3g} N m/rad, these {:g} kg at {:g} m give {:.3g}; see "
        "--mass and --height",
        toppling(rig), plan.mass_kg, plan.mass_height_m,
        -model::kGravity * plan.mass_kg * plan.mass_height_m);
  }
  return {};
}

std::string by_hand(const ExperimentPlan& plan, bool simulated) {
  if (simulated) return {};
  std::string work;
  const auto add = [&work](const std::string& what) { work += (work.empty() ? "" : "; ") + what; };
  if (plan.kind->structure_pinned) add("pin the structure upright, so that it does not give way");
  if (plan.kind->disc_pinned) add("pin the disc to it");
  if (plan.kind->axles_lifted) add("lift the axles off their ring, if there is one, and tie them");
  if (is_named(plan, "swing")) {
    add(
        fmt::format("bolt {:g} kg to the structure, centre of mass {:g} m below the pivot; lean it "
                    "by about {:.0f} deg and let go once it is armed",
                    plan.mass_kg, -plan.mass_height_m, plan.tilt_rad * 180.0 / std::numbers::pi));
  }
  return work;
}

}  // namespace gyrotwin
