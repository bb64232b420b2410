// Momentum manager: the drive holds the momentum of disc and gyros about z_D, not the disc's speed.
#pragma once

#include "services/controller/law.hpp"

namespace gyrotwin {

/// p = C phi' + N h (sin tg - sin tg0), which no contact force changes, is led to -C Om0 at the
/// rate kappa; friction is compensated:
///   tau = kappa (-C Om0 - p) + fcD tanh(phi'/0.05) + bD phi' + kd (tg - z),  z' = 2 (tg - z).
class MomentumManager final : public Law {
 public:
  /// @pre the rig is an umbrella platform and has the law's numbers
  explicit MomentumManager(const Rig& rig);

  int states() const noexcept override { return 1; }
  LawState start(const model::Observation& seen) const noexcept override {
    return {seen.gimbal_angle[0], 0.0};
  }
  DriveTorques torque(const model::Observation& seen, const LawState& z) const noexcept override;
  LawState rates(const model::Observation& seen, const LawState& z, const DriveTorques& wanted,
                 const DriveTorques& given) const noexcept override;
  std::string describe() const override;

 private:
  model::ReducedUmbrella platform_;
  model::DiscFriction friction_;
  double sin_ring_;        // sin tg0 [1]
  double disc_speed_;      // Om0 [rad/s]
  double momentum_rate_;   // kappa [1/s]
  double elevation_gain_;  // kd [N m/rad]
};

}  // namespace gyrotwin
