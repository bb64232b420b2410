#include "clients/analyze/conditions.hpp"

#include <variant>

#include "clients/analyze/gimballed_theory.hpp"
#include "clients/analyze/umbrella_theory.hpp"

namespace gyrotwin {

Theory theory_of(const Rig& rig, const std::optional<LinearModel>& linear) {
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    return umbrella_theory(rig, *umbrella, linear);
  }
  if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return gimballed_theory(rig, *gimballed);
  }
  return gyroscope_theory(rig, std::get<model::GyroscopeParameters>(rig.machine));
}

}  // namespace gyrotwin
