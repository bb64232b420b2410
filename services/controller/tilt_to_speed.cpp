#include "services/controller/tilt_to_speed.hpp"

#include <algorithm>
#include <cstdio>

#include "services/controller/branch.hpp"
#include "services/controller/feedback.hpp"
#include "services/controller/riccati.hpp"

namespace gyrotwin {

TiltToSpeed::TiltToSpeed(const Rig& rig)
    : disc_speed_(rig.controller.disc_speed.value()),
      tilt_gain_(rig.controller.tilt_speed_gain.value()),
      rate_gain_(rig.controller.rate_speed_gain.value()),
      limit_(rig.controller.speed_limit.value()),
      loop_(rig.controller) {
  const Branch branch = branch_of(std::get<model::UmbrellaParameters>(rig.machine));
  const Eigen::RowVector3d to_error(-tilt_gain_, -rate_gain_, -1.0);
  Eigen::Matrix4d F;  // of (th, th', phi', z)
  F << branch.F + branch.B * loop_.kp() * to_error, branch.B, loop_.ki() * to_error, 0.0;
  poles_ = poles(F);
}

double TiltToSpeed::error(const model::Observation& seen) const noexcept {
  const auto [tilt, rate] = tilt_magnitude(seen);
  const double speed = disc_speed_ + tilt_gain_ * tilt + rate_gain_ * rate;
  return -std::clamp(speed, 0.0, limit_) - seen.disc_rate;
}

DriveTorques TiltToSpeed::torque(const model::Observation& seen, const LawState& z) const noexcept {
  return {loop_.torque(error(seen), z[0])};
}

LawState TiltToSpeed::rates(const model::Observation& seen, const LawState& z,
                            const DriveTorques& wanted, const DriveTorques& given) const noexcept {
  return {loop_.rate(error(seen), z[0], wanted[0], given[0]), 0.0};
}

std::string TiltToSpeed::describe() const {
  char text[160];
  std::snprintf(text, sizeof text,
                "tilt_to_speed: disc at -(%.4g + %.4g th + %.4g th') rad/s, from 0 to -%.4g, ",
                disc_speed_, tilt_gain_, rate_gain_, limit_);
  return text + loop_.describe() + ", closed-loop poles on one branch " + listed(poles_);
}

}  // namespace gyrotwin
