// Follows a live rig: from SENSORS and what its drives did to the most likely state of its model,
// and how sure that is. Pure; README.md beside it has the equations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// What is most likely. World and IMU axes as in state_t.lcm and sensors_t.lcm.
struct Estimate {
  model::State state;                                            ///< q, v, rotor speeds; now
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< IMU axes [rad/s]
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< IMU axes [m/s^2]
  /// Unknown moment on the structure about x and y, and its standard deviation [N m].
  Eigen::Vector2d external_moment = Eigen::Vector2d::Zero();
  Eigen::Vector2d external_moment_sigma = Eigen::Vector2d::Zero();
  /// Friction of the disc beyond the model's, against its turning [N m].
  double disc_friction = 0.0, disc_friction_sigma = 0.0;
  /// The structure's tilt inertia beyond the model's, as a share of it [1].
  double inertia = 0.0, inertia_sigma = 0.0;
  /// Share of the asked torque that arrives from each drive [1].
  std::array<double, model::kMaxDrives> drive_strength{1, 1, 1, 1}, drive_strength_sigma{};
};

/// As in health_t: index i is the VALID_* bit i of sensors_t.
inline constexpr int kHealthSensors = 8;

/// One sensor in the last step, before it was used.
struct Innovation {
  static constexpr int kMaxChannels = 4;
  int channels = 0;                             ///< heard and sane; 0: silent, or no such sensor
  std::array<double, kMaxChannels> value{};     ///< measured minus expected [unit of the sensor]
  std::array<double, kMaxChannels> expected{};  ///< [unit of the sensor]
  /// Normalised innovation squared, of all channels together, once pushes are taken for what they
  /// are; its mean is `channels`.
  double nis = 0.0;
  bool insane = false;   ///< said what no sensor says; such a channel is not used
  bool stuck = false;    ///< says the same for longer than it can; not used
  bool refused = false;  ///< not believed in this step
};

/// What a sensor is off by, constantly [unit of the sensor].
struct Bias {
  double value = 0.0, sigma = 0.0;
  double prior = 0.0;  ///< standard deviation that the rig file gives it
};

class Follower {
 public:
  /// @param machine the rig's; must outlive the follower
  /// @throws Error where the rig has no [sensors]
  Follower(const Rig& rig, const model::Machine& machine);
  ~Follower();

  /// At tick 0 at rest (HELD) as the sensors say; to be called with any SENSORS of HELD, the last
  /// one counts. At a later tick anywhere in a swing, with a wide uncertainty.
  void start(const sensors_t& first) noexcept;
  /// One tick. Ticks that the header leaves out are bridged.
  /// @param acting what the drives did over the tick that ended with these readings: mode and
  /// drive.
  ///        While they brake nothing is learned of drives whose current nobody measures
  void step(const sensors_t& sensors, const model::Input& acting) noexcept;

  /// Sensors that are judged, but not used from the next step on: sum of VALID_*, see
  /// Health::distrusted().
  void distrust(std::int32_t sensors) noexcept;

  const Estimate& estimate() const noexcept;
  /// Whether transients of the start are over.
  bool settled() const noexcept;
  /// How often it lost the rig, as nothing explained the readings, and started anew.
  int losses() const noexcept;
  /// state_t.VALID_* groups that mean something.
  std::int32_t valid() const noexcept;

  /// Of (q, v), in the machine's order.
  int dimension() const noexcept;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                                   2 * model::kMaxCoordinates, 2 * model::kMaxCoordinates>;
  /// Lower triangular S with S S' the covariance of (q, v). Does not allocate.
  Covariance deviation() const noexcept;
  /// A state that the uncertainty allows: the estimate plus S times `dimension()` normal numbers.
  /// @param normal independent, of variance 1; those from index * dimension() on are taken
  model::State draw(int index, std::span<const double> normal) const noexcept;

  Bias bias(int sensor, int channel) const noexcept;

  /// Of the last step, per sensor.
  const std::array<Innovation, kHealthSensors>& innovations() const noexcept;

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace gyrotwin
