// State feedback on the platform's planar reduced model.
#pragma once

#include "services/controller/feedback.hpp"
#include "services/controller/law.hpp"

namespace gyrotwin {

/// tau = -K (th, th', phi' + Om0) + fcD tanh(phi'/0.05), th = |tilt| >= 0 and th' its rate: K for
/// the linear model of Branch.
class ReducedLqr final : public Law {
 public:
  /// @pre the rig is an umbrella platform and has the law's numbers
  /// @throws Error when the gain has not three numbers, or no gain stabilises
  explicit ReducedLqr(const Rig& rig);

  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  std::string describe() const override;
  const Feedback& feedback() const { return feedback_; }

 private:
  Feedback feedback_;
  Eigen::RowVector3d K_;  // the feedback's gain in fixed size, for the tick
  double disc_speed_;     // Om0 [rad/s]
  double coulomb_;        // fcD [N m]
};

}  // namespace gyrotwin
