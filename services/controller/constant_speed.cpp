#include "services/controller/constant_speed.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "services/controller/settings.hpp"

namespace gyrotwin {

ConstantSpeed::ConstantSpeed(const Rig& rig)
    : disc_speed_(required(rig, rig.controller.disc_speed, "disc_speed_rad_s")),
      kp_(required(rig, rig.controller.kp, "kp_nms_per_rad")),
      ki_(required(rig, rig.controller.ki, "ki_nm_per_rad")),
      integral_limit_(required(rig, rig.controller.integral_limit, "integral_limit_nm")) {}

DriveTorques ConstantSpeed::torque(const model::Observation& seen,
                                   const LawState& z) const noexcept {
  return {kp_ * error(seen) + std::clamp(z[0], -integral_limit_, integral_limit_)};
}

LawState ConstantSpeed::rates(const model::Observation& seen, const LawState& z,
                              const DriveTorques& wanted,
                              const DriveTorques& given) const noexcept {
  const double rate = ki_ * error(seen);
  const bool at_limit = std::abs(z[0]) >= integral_limit_ && z[0] * rate > 0.0;
  const bool saturated = (wanted[0] - given[0]) * rate > 0.0;
  return {at_limit || saturated ? 0.0 : rate, 0.0};
}

std::string ConstantSpeed::describe() const {
  char text[160];
  std::snprintf(text, sizeof text,
                "constant_speed: disc at %.4g rad/s, kp = %.4g N m s/rad, ki = %.4g N m/rad, "
                "integral at most %.4g N m",
                -disc_speed_, kp_, ki_, integral_limit_);
  return text;
}

}  // namespace gyrotwin
