#include "services/controller/precession.hpp"

#include "services/controller/riccati.hpp"

namespace gyrotwin {

Precession::Precession(const Rig& rig)
    : axes_(std::get<model::GimballedParameters>(rig.machine)),
      K_(rig.controller.tilt_gain.value(), 0.0, -rig.controller.gimbal_gain.value(),
         rig.controller.gimbal_damping.value()),
      feedback_{K_, poles(axes_.F() - axes_.B() * K_)} {}

DriveTorques Precession::torque(const model::Observation& seen,
                                const LawState& /*z*/) const noexcept {
  return axes_.each(seen, [this](const AxisState& x) { return -K_.dot(x); });
}

std::string Precession::describe() const {
  return "precession: u = -kth th - cq q' + kap q = -K (th, th', q, q'), " + feedback_.describe();
}

}  // namespace gyrotwin
