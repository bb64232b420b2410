// Tilt to speed: the disc turns faster the more the structure tilts, so that the ring presses back
// harder.
#pragma once

#include <Eigen/Core>

#include "services/controller/law.hpp"
#include "services/controller/speed_loop.hpp"

namespace gyrotwin {

/// phi' is led to -clip(Om0 + kth th + kr th', 0, limit) by a SpeedLoop, th = |tilt|.
class TiltToSpeed final : public Law {
 public:
  /// @pre the rig is an umbrella platform and has the law's numbers
  explicit TiltToSpeed(const Rig& rig);

  int states() const noexcept override { return 1; }
  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  LawState rates(const model::Observation& seen, const LawState& z, const DriveTorques& wanted,
                 const DriveTorques& given) const noexcept override;
  std::string describe() const override;

 private:
  double error(const model::Observation& seen) const noexcept;

  double disc_speed_;  // Om0 [rad/s]
  double tilt_gain_;   // kth [1/s]
  double rate_gain_;   // kr [1]
  double limit_;       // [rad/s]
  SpeedLoop loop_;
  Eigen::VectorXcd poles_;  // on one branch, below every limit
};

}  // namespace gyrotwin
