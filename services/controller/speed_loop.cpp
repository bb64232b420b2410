#include "services/controller/speed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gyrotwin {

double SpeedLoop::torque(double error, double z) const noexcept {
  return kp_ * error + std::clamp(z, -integral_limit_, integral_limit_);
}

double SpeedLoop::rate(double error, double z, double wanted, double given) const noexcept {
  const double rate = ki_ * error;
  const bool at_limit = std::abs(z) >= integral_limit_ && z * rate > 0.0;
  const bool saturated = (wanted - given) * rate > 0.0;
  return at_limit || saturated ? 0.0 : rate;
}

std::string SpeedLoop::describe() const {
  char text[128];
  std::snprintf(text, sizeof text,
                "kp = %.4g N m s/rad, ki = %.4g N m/rad, integral at most %.4g N m", kp_, ki_,
                integral_limit_);
  return text;
}

}  // namespace gyrotwin
