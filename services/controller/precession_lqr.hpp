// State feedback for gimballed gyros: tilt is held by turning the flywheels' momentum.
#pragma once

#include <array>

#include "services/controller/feedback.hpp"
#include "services/controller/law.hpp"

namespace gyrotwin {

/// u = -sign K (th, th', sign q, sign q') for each gimbal drive, th the tilt that its gyros hold.
/// The linear model at sign = +1: A th'' = U th - cth th' + H q',  J q'' = u - H th' - cq q'.
/// sign is -1 where the gimbal's positive turn pushes the tilt the other way: the single gyro and
/// the pitch pair. Both tilts of two pairs have the same model, hence the same K.
class PrecessionLqr final : public Law {
 public:
  /// @pre the rig is a gimballed machine
  /// @throws Error when a number is missing or no gain stabilises
  explicit PrecessionLqr(const Rig& rig);

  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  std::string describe() const override;
  const Feedback& feedback() const { return feedback_; }

 private:
  struct Axis {
    int tilt;            // of Observation::tilt
    int gimbal;          // a gyro on the drive's coordinate
    double coefficient;  // its angle per coordinate, +-1
    double sign;
  };

  Feedback feedback_;
  Eigen::RowVector4d K_;  // the feedback's gain in fixed size, for the tick
  std::array<Axis, model::kMaxDrives> axes_{};
  int count_ = 0;
};

}  // namespace gyrotwin
