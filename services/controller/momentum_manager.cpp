#include "services/controller/momentum_manager.hpp"

#include <cmath>
#include <cstdio>

namespace gyrotwin {

namespace {

/// Below it the elevation is a resting load, to which kd shall not answer [rad/s].
constexpr double kCorner = 2.0;

}  // namespace

MomentumManager::MomentumManager(const Rig& rig)
    : disc_speed_(rig.controller.disc_speed.value()),
      momentum_rate_(rig.controller.momentum_rate.value()),
      elevation_gain_(rig.controller.elevation_gain.value_or(0.0)) {
  const auto& p = std::get<model::UmbrellaParameters>(rig.machine);
  platform_ = model::reduce(p);
  friction_ = {p.disc.viscous_friction, p.disc.coulomb_friction};
  sin_ring_ = std::sin(p.gyros.ring_elevation);
}

DriveTorques MomentumManager::torque(const model::Observation& seen,
                                     const LawState& z) const noexcept {
  const double tg = seen.gimbal_angle[0];
  const double w = seen.disc_rate;
  const double momentum = platform_.C * w + platform_.Nh * (std::sin(tg) - sin_ring_);
  const double friction =
      friction_.coulomb * std::tanh(w / model::DiscFriction::kCreep) + friction_.viscous * w;
  return {momentum_rate_ * (-platform_.C * disc_speed_ - momentum) + friction +
          elevation_gain_ * (tg - z[0])};
}

LawState MomentumManager::rates(const model::Observation& seen, const LawState& z,
                                const DriveTorques& /*wanted*/,
                                const DriveTorques& /*given*/) const noexcept {
  return {kCorner * (seen.gimbal_angle[0] - z[0]), 0.0};
}

std::string MomentumManager::describe() const {
  char text[192];
  std::snprintf(text, sizeof text,
                "momentum_manager: momentum %.4g N m s (disc at %.4g rad/s on a rigid ring), "
                "kappa = %.4g 1/s, kd = %.4g N m/rad",
                -platform_.C * disc_speed_, -disc_speed_, momentum_rate_, elevation_gain_);
  return text;
}

}  // namespace gyrotwin
