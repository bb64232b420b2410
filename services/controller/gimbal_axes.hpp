// Gimbal drives one by one, each with the tilt that its gyros hold, signs turned so that one linear
// model serves all of them.
#pragma once

#include <Eigen/Core>
#include <array>

#include "services/controller/law.hpp"
#include "services/model/gimballed.hpp"

namespace gyrotwin {

/// (th, th', q, q') of one axis, at sign +1.
using AxisState = Eigen::Vector4d;

/// The linear model at sign +1, u the drive's torque:
///   A th'' = U th - cth th' + H q',  J q'' = u - H th' - cq q'.
/// The sign is -1 where the gimbal's positive turn pushes the tilt the other way: the single gyro
/// and the pitch pair. Both tilts of two pairs have the same model.
class GimbalAxes {
 public:
  explicit GimbalAxes(const model::GimballedParameters& parameters);

  /// Torques per drive, of a law u(AxisState) [N m] at sign +1.
  template <class Torque>
  DriveTorques each(const model::Observation& seen, const Torque& u) const noexcept {
    DriveTorques torques{};
    for (int i = 0; i < count_; ++i) {
      const Axis& axis = axes_[i];
      const double direction = axis.sign * axis.coefficient;
      torques[i] = axis.sign * u(AxisState(seen.tilt[axis.tilt], seen.tilt_rate[axis.tilt],
                                           direction * seen.gimbal_angle[axis.gimbal],
                                           direction * seen.gimbal_rate[axis.gimbal]));
    }
    return torques;
  }

  /// x' = F x + B u of an AxisState.
  const Eigen::Matrix4d& F() const { return F_; }
  const Eigen::Vector4d& B() const { return B_; }

 private:
  struct Axis {
    int tilt;            // of Observation::tilt
    int gimbal;          // a gyro on the drive's coordinate
    double coefficient;  // its angle per coordinate, +-1
    double sign;
  };

  Eigen::Matrix4d F_;
  Eigen::Vector4d B_;
  std::array<Axis, model::kMaxDrives> axes_{};
  int count_ = 0;
};

}  // namespace gyrotwin
