// State feedback for gimballed gyros: tilt is held by turning the flywheels' momentum.
#pragma once

#include "services/controller/feedback.hpp"
#include "services/controller/gimbal_axes.hpp"

namespace gyrotwin {

/// u = -K (th, th', q, q') for each gimbal drive, signs as GimbalAxes has them.
class PrecessionLqr final : public Law {
 public:
  /// @pre the rig is a gimballed machine and has the law's numbers
  /// @throws Error when the gain has not four numbers, or no gain stabilises
  explicit PrecessionLqr(const Rig& rig);

  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  std::string describe() const override;
  const Feedback& feedback() const { return feedback_; }

 private:
  GimbalAxes axes_;
  Feedback feedback_;
  Eigen::RowVector4d K_;  // the feedback's gain in fixed size, for the tick
};

}  // namespace gyrotwin
