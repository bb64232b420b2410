// Brennan's shelves: the flywheels' axles roll on the shelf that the tilt brings up to them.
#pragma once

#include "services/controller/feedback.hpp"
#include "services/controller/gimbal_axes.hpp"

namespace gyrotwin {

/// u = -Ts tanh(th / th_s) - cq q' + kap q for each gimbal drive, signs as GimbalAxes has them. The
/// friction wheel drives the precession the way it already goes, at most with the friction Ts;
/// th_s is the tilt that presses it on; cq is the gimbal's dashpot, kap q the free wheel's shelf.
class Shelf final : public Law {
 public:
  /// @pre the rig is a gimballed machine and has the law's numbers
  explicit Shelf(const Rig& rig);

  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  std::string describe() const override;
  /// Near upright, where it is linear: kth = Ts / th_s.
  const Feedback& feedback() const { return feedback_; }

 private:
  GimbalAxes axes_;
  double friction_;  // Ts [N m]
  double tilt_;      // th_s [rad]
  double spring_;    // kap [N m/rad]
  double damping_;   // cq [N m s/rad]
  Feedback feedback_;
};

}  // namespace gyrotwin
