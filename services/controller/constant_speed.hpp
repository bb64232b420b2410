// Constant disc speed: the ring presses each axle back with H Om0, whatever the tilt.
#pragma once

#include "services/controller/law.hpp"
#include "services/controller/speed_loop.hpp"

namespace gyrotwin {

/// tau = kp e + z with e = -Om0 - phi' and z' = ki e: see SpeedLoop. On a gyroscope phi is psi, the
/// turn about the post.
class ConstantSpeed final : public Law {
 public:
  /// @pre the rig has a disc or a post, and the law's numbers
  explicit ConstantSpeed(const Rig& rig);

  int states() const noexcept override { return 1; }
  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  LawState rates(const model::Observation& seen, const LawState& z, const DriveTorques& wanted,
                 const DriveTorques& given) const noexcept override;
  std::string describe() const override;

 private:
  double error(const model::Observation& seen) const noexcept {
    return -disc_speed_ - seen.disc_rate;
  }

  double disc_speed_;  // Om0 [rad/s]
  SpeedLoop loop_;
};

}  // namespace gyrotwin
