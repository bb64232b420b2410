#include "clients/analyze/conditions.hpp"

#include <variant>

#include "clients/analyze/gimballed_theory.hpp"
#include "clients/analyze/umbrella_theory.hpp"

namespace gyrotwin {

namespace {

Theory of_machine(const Rig& rig, const std::optional<LinearModel>& linear) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    return umbrella_theory(rig, *umbrella, linear);
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return gimballed_theory(rig, *gimballed);
  }
  return gyroscope_theory(rig, std::get<model::GyroscopeParameters>(rig.machine));
}

}  // namespace

Theory theory_of(const Rig& rig, const std::optional<LinearModel>& linear) {
  Theory theory = of_machine(rig, linear);
  if (rig.load_cell) {  // it may hold what the formulas, which do not know it, let fall
    for (Condition& condition : theory.conditions) {
      if (condition.decides()) condition.role = Role::kAdvises;
    }
  }
  return theory;
}

}  // namespace gyrotwin
