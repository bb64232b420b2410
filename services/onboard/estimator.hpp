// The onboard estimator: from what the sensors say to STATE. The same one on a simulated rig with
// `loop.state = "estimate"` and on a real one. Pure; README.md beside it has the equations.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/onboard/gh_filter.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class OnboardEstimator {
 public:
  /// A silent sensor's angle goes on at its last rate for so long [s]; then its group is unknown.
  static constexpr double kCoast = 0.02;
  /// Poles of the tilt from the accelerometer alone, while the gyro is silent [rad/s].
  static constexpr double kInclinometer = 20.0;

  /// @pre rig.sensors
  /// @param machine the rig's; must outlive the estimator
  OnboardEstimator(const Rig& rig, const model::Machine& machine);

  /// As one that has watched a platform at rest in this state for long; gyro bias 0.
  void reset(const model::Observation& seen) noexcept;
  /// As one that knows nothing yet: the next readings, taken at rest, say where the platform is.
  void forget() noexcept;
  /// One tick of the rig's length. A sensor that is not valid, or says what is not finite, is done
  /// without: its quantity is carried on by what remains.
  void step(const sensors_t& sensors) noexcept;

  /// Groups that it cannot know are 0, see valid().
  const model::Observation& seen() const noexcept { return seen_; }
  /// Sum of state_t.VALID_*: what seen() means something for. VALID_DRIVES is not its business.
  std::int32_t valid() const noexcept { return valid_; }

 private:
  using Tilts = std::array<double, 2>;

  bool follow(const GhFilter& filter, Track& track, std::optional<double> measured) const noexcept;
  std::optional<Tilts> inclination(const sensors_t& sensors,
                                   const std::optional<Eigen::Vector3d>& omega) const noexcept;
  bool estimate_tilt(const sensors_t& sensors) noexcept;
  bool integrate_gyro(const Tilts& rates, const std::optional<Tilts>& inclined) noexcept;
  bool follow_inclination(const std::optional<Tilts>& inclined) noexcept;
  bool estimate_disc_tilt() noexcept;
  bool estimate_disc(const sensors_t& sensors) noexcept;
  std::optional<double> measured_gimbal(int coordinate, const sensors_t& sensors) const noexcept;
  bool estimate_gimbals(const sensors_t& sensors) noexcept;
  bool estimate_rotors(const sensors_t& sensors) noexcept;

  const model::Machine& machine_;
  double tick_s_;
  int coast_ticks_;
  int tilts_;                 // 0, 1 or 2
  Eigen::Matrix3d from_imu_;  // structure <- IMU
  Eigen::Vector3d imu_position_;
  GhFilter tilt_filter_, inclinometer_filter_, disc_filter_, gimbal_filter_;

  std::array<Track, 2> tilt_;          // drift: minus the gyro's bias
  std::array<Track, 2> inclinometer_;  // the tilt while the gyro is silent
  bool tilt_known_ = true;
  std::optional<Eigen::Vector3d> last_omega_;  // structure axes [rad/s]
  std::optional<Tilts> last_rates_;            // by the gyro [rad/s]
  Track disc_;
  std::array<Track, model::kMaxCoordinates> gimbal_;  // by coordinate

  model::Observation seen_;
  std::int32_t valid_ = 0;
};

}  // namespace gyrotwin
