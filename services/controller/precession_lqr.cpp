#include "services/controller/precession_lqr.hpp"

namespace gyrotwin {

PrecessionLqr::PrecessionLqr(const Rig& rig)
    : axes_(std::get<model::GimballedParameters>(rig.machine)),
      feedback_(feedback_for(rig, axes_.F(), axes_.B(),
                             {{0, rig.controller.tilt_max}, {2, rig.controller.gimbal_max}})),
      K_(feedback_.K) {}

DriveTorques PrecessionLqr::torque(const model::Observation& seen,
                                   const LawState& /*z*/) const noexcept {
  return axes_.each(seen, [this](const AxisState& x) { return -K_.dot(x); });
}

std::string PrecessionLqr::describe() const {
  return "precession_lqr: u = -K (th, th', q, q'), " + feedback_.describe();
}

}  // namespace gyrotwin
