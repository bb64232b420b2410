// Constant disc speed: the ring presses each axle back with H Om0, whatever the tilt.
#pragma once

#include "services/controller/law.hpp"

namespace gyrotwin {

/// tau = kp e + z with e = -Om0 - phi' and z' = ki e, |z| at most the integral limit. z is held
/// where the drive is at its limit and e asks for more.
class ConstantSpeed final : public Law {
 public:
  /// @pre the rig is an umbrella platform
  /// @throws Error when a number is missing
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

  double disc_speed_;      // Om0 [rad/s]
  double kp_;              // [N m s/rad]
  double ki_;              // [N m/rad]
  double integral_limit_;  // [N m]
};

}  // namespace gyrotwin
