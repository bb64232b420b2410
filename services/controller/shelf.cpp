#include "services/controller/shelf.hpp"

#include <cmath>

#include "services/controller/riccati.hpp"

namespace gyrotwin {

Shelf::Shelf(const Rig& rig)
    : axes_(std::get<model::GimballedParameters>(rig.machine)),
      friction_(rig.controller.shelf_torque.value()),
      tilt_(rig.controller.shelf_tilt.value()),
      spring_(rig.controller.gimbal_gain.value()),
      damping_(rig.controller.gimbal_damping.value()) {
  const Eigen::RowVector4d K(friction_ / tilt_, 0.0, -spring_, damping_);
  feedback_ = {K, poles(axes_.F() - axes_.B() * K)};
}

DriveTorques Shelf::torque(const model::Observation& seen, const LawState& /*z*/) const noexcept {
  return axes_.each(seen, [this](const AxisState& x) {
    return -friction_ * std::tanh(x[0] / tilt_) - damping_ * x[3] + spring_ * x[2];
  });
}

std::string Shelf::describe() const {
  return "shelf: u = -Ts tanh(th / th_s) - cq q' + kap q, near upright -K (th, th', q, q') with " +
         feedback_.describe();
}

}  // namespace gyrotwin
