#include "services/controller/reduced_lqr.hpp"

#include <cmath>

#include "services/controller/branch.hpp"

namespace gyrotwin {

namespace {

Feedback regulate(const Rig& rig) {
  const Branch branch = branch_of(std::get<model::UmbrellaParameters>(rig.machine));
  return feedback_for(rig, branch.F, branch.B,
                      {{0, rig.controller.tilt_max}, {2, rig.controller.speed_max}});
}

}  // namespace

ReducedLqr::ReducedLqr(const Rig& rig)
    : feedback_(regulate(rig)),
      K_(feedback_.K),
      disc_speed_(rig.controller.disc_speed.value()),
      coulomb_(std::get<model::UmbrellaParameters>(rig.machine).disc.coulomb_friction) {}

DriveTorques ReducedLqr::torque(const model::Observation& seen,
                                const LawState& /*z*/) const noexcept {
  const auto [tilt, rate] = tilt_magnitude(seen);
  const Eigen::Vector3d state(tilt, rate, seen.disc_rate + disc_speed_);
  return {-K_.dot(state) + coulomb_ * std::tanh(seen.disc_rate / model::DiscFriction::kCreep)};
}

std::string ReducedLqr::describe() const {
  return "reduced_lqr: tau = -K (th, th', phi' + Om0), " + feedback_.describe();
}

}  // namespace gyrotwin
