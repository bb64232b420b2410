// Proportional plus integral control of the disc's speed, with one memory entry: the integral.
#pragma once

#include <string>

#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// tau = kp e + z and z' = ki e, |z| at most the integral limit, for a speed error e [rad/s]. z is
/// held where the drive is at its limit and e asks for more (conditional integration).
class SpeedLoop {
 public:
  /// @pre the numbers are there
  explicit SpeedLoop(const Rig::Controller& controller)
      : kp_(controller.kp.value()),
        ki_(controller.ki.value()),
        integral_limit_(controller.integral_limit.value()) {}

  /// tau [N m].
  double torque(double error, double z) const noexcept;
  /// z' [N m/s], given what was wanted and what the drive can give [N m].
  double rate(double error, double z, double wanted, double given) const noexcept;
  /// "kp = ..., ki = ..., integral at most ...".
  std::string describe() const;

  double kp() const noexcept { return kp_; }
  double ki() const noexcept { return ki_; }

 private:
  double kp_;              // [N m s/rad]
  double ki_;              // [N m/rad]
  double integral_limit_;  // [N m]
};

}  // namespace gyrotwin
