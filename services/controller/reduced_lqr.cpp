#include "services/controller/reduced_lqr.hpp"

#include <algorithm>
#include <cmath>

#include "services/controller/settings.hpp"

namespace gyrotwin {

namespace {

Feedback regulate(const Rig& rig) {
  const auto& p = std::get<model::UmbrellaParameters>(rig.machine);
  const auto [A, C, U, H, k, Nh] = model::reduce(p);
  const double cs = p.structure.damping;
  const double b = p.disc.viscous_friction;
  Eigen::Matrix3d F;
  F << 0.0, 1.0, 0.0,  //
      U / A, -cs / A, H / A, 0.0, -H / C, -b / C;
  const Eigen::Vector3d B(0.0, 0.0, 1.0 / C);
  return feedback_for(rig, F, B,
                      {{0, rig.controller.tilt_max, "tilt_max_rad"},
                       {2, rig.controller.speed_max, "speed_max_rad_s"}});
}

}  // namespace

ReducedLqr::ReducedLqr(const Rig& rig)
    : feedback_(regulate(rig)),
      K_(feedback_.K),
      disc_speed_(required(rig, rig.controller.disc_speed, "disc_speed_rad_s")),
      coulomb_(std::get<model::UmbrellaParameters>(rig.machine).disc.coulomb_friction) {}

DriveTorques ReducedLqr::torque(const model::Observation& seen,
                                const LawState& /*z*/) const noexcept {
  constexpr double kUpright = 1e-9;  // [rad] below it the tilt has no direction: th' is 0
  const auto [x, y] = seen.tilt;
  const auto [vx, vy] = seen.tilt_rate;
  const double th = std::hypot(x, y);
  const double th_rate = (x * vx + y * vy) / std::max(th, kUpright);
  const Eigen::Vector3d state(th, th_rate, seen.disc_rate + disc_speed_);
  return {-K_.dot(state) + coulomb_ * std::tanh(seen.disc_rate / model::DiscFriction::kCreep)};
}

std::string ReducedLqr::describe() const {
  return "reduced_lqr: tau = -K (th, th', phi' + Om0), " + feedback_.describe();
}

}  // namespace gyrotwin
