// The classical law of gimballed gyros: drive the precession onward the way it already goes.
#pragma once

#include "services/controller/feedback.hpp"
#include "services/controller/gimbal_axes.hpp"

namespace gyrotwin {

/// u = -kth th - cq q' + kap q for each gimbal drive, signs as GimbalAxes has them.
class Precession final : public Law {
 public:
  /// @pre the rig is a gimballed machine and has the law's numbers
  explicit Precession(const Rig& rig);

  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  std::string describe() const override;
  /// The same as u = -K x, with the closed loop's poles, stable or not.
  const Feedback& feedback() const { return feedback_; }

 private:
  GimbalAxes axes_;
  Eigen::RowVector4d K_;  // (kth, 0, -kap, cq)
  Feedback feedback_;
};

}  // namespace gyrotwin
