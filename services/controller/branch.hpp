// The umbrella platform's planar reduced model on one branch, tilt taken as a magnitude.
#pragma once

#include <Eigen/Core>

#include "services/model/umbrella.hpp"

namespace gyrotwin {

/// Tilt of the structure as a magnitude, and how fast it grows.
struct TiltMagnitude {
  double angle;  ///< th = hypot(thx, thy) [rad]
  double rate;   ///< th' = (thx thx' + thy thy') / th, 0 where the tilt has no direction [rad/s]
};
TiltMagnitude tilt_magnitude(const model::Observation& seen) noexcept;

/// (th, th', phi')' = F (th, th', phi') + B tau:
///   A th'' = U th - cs th' + H phi',  C phi'' = tau - H th' - bD phi'.
struct Branch {
  Eigen::Matrix3d F;
  Eigen::Vector3d B;
};
Branch branch_of(const model::UmbrellaParameters& parameters);

}  // namespace gyrotwin
