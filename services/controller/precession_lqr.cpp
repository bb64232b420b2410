#include "services/controller/precession_lqr.hpp"

#include <algorithm>

namespace gyrotwin {

namespace {

Feedback regulate(const Rig& rig) {
  const auto [A, J, U, H, cth, cq] =
      model::reduce(std::get<model::GimballedParameters>(rig.machine));
  Eigen::Matrix4d F;
  F << 0.0, 1.0, 0.0, 0.0,          //
      U / A, -cth / A, 0.0, H / A,  //
      0.0, 0.0, 0.0, 1.0,           //
      0.0, -H / J, 0.0, -cq / J;
  const Eigen::Vector4d B(0.0, 0.0, 0.0, 1.0 / J);
  return feedback_for(rig, F, B,
                      {{0, rig.controller.tilt_max, "tilt_max_rad"},
                       {2, rig.controller.gimbal_max, "gimbal_max_rad"}});
}

}  // namespace

PrecessionLqr::PrecessionLqr(const Rig& rig) : feedback_(regulate(rig)), K_(feedback_.K) {
  const auto& p = std::get<model::GimballedParameters>(rig.machine);
  const model::Machine machine = model::build(p);
  const auto& gimbals = machine.layout.gimbals;
  for (const model::Drive& drive : machine.drives) {
    const auto gyro = std::find_if(gimbals.begin(), gimbals.end(), [&](const auto& gimbal) {
      return gimbal.coordinate == drive.coordinate;
    });
    const bool opposed = p.arrangement == model::Arrangement::kSingle || count_ == 1;
    axes_[count_] = {count_, static_cast<int>(gyro - gimbals.begin()), gyro->coefficient,
                     opposed ? -1.0 : 1.0};
    ++count_;
  }
}

DriveTorques PrecessionLqr::torque(const model::Observation& seen,
                                   const LawState& /*z*/) const noexcept {
  DriveTorques u{};
  for (int i = 0; i < count_; ++i) {
    const Axis& axis = axes_[i];
    const double direction = axis.sign * axis.coefficient;
    const Eigen::Vector4d state(seen.tilt[axis.tilt], seen.tilt_rate[axis.tilt],
                                direction * seen.gimbal_angle[axis.gimbal],
                                direction * seen.gimbal_rate[axis.gimbal]);
    u[i] = -axis.sign * K_.dot(state);
  }
  return u;
}

std::string PrecessionLqr::describe() const {
  return "precession_lqr: u = -K (th, th', q, q'), " + feedback_.describe();
}

}  // namespace gyrotwin
