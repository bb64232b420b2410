#include "services/controller/branch.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

TiltMagnitude tilt_magnitude(const model::Observation& seen) noexcept {
  constexpr double kUpright = 1e-9;  // [rad] below it the tilt has no direction: th' is 0
  const auto [x, y] = seen.tilt;
  const auto [vx, vy] = seen.tilt_rate;
  const double angle = std::hypot(x, y);
  return {angle, (x * vx + y * vy) / std::max(angle, kUpright)};
}

Branch branch_of(const model::UmbrellaParameters& p) {
  const auto [A, C, U, H, k, Nh] = model::reduce(p);
  const double cs = p.structure.damping;
  const double b = p.disc.viscous_friction;
  Branch branch;
  branch.F << 0.0, 1.0, 0.0,  //
      U / A, -cs / A, H / A,  //
      0.0, -H / C, -b / C;
  branch.B << 0.0, 0.0, 1.0 / C;
  return branch;
}

}  // namespace gyrotwin
