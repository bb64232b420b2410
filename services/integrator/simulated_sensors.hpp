// What the rig's sensors would say of a simulated plant: mounting, noise, bias, resolution, delay.
#pragma once

#include <array>
#include <cstdint>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class SimulatedSensors {
 public:
  /// @pre rig.sensors
  /// @param machine the rig's; must outlive the sensors
  SimulatedSensors(const Rig& rig, const model::Machine& machine);

  /// Forgets what is delayed. The same seed gives the same noise in every run.
  void reset() noexcept;
  /// Everything of `sensors` but header and mac, at `tick` (one call a tick, in order). Until the
  /// delay is over after reset(): what was measured first.
  /// @param truth of this state and input
  void measure(std::int64_t tick, const model::State& state, const model::Input& input,
               const model::Truth& truth, sensors_t& sensors) noexcept;

 private:
  /// Where the first of each kind stands among the scalar sensors. Sensor i draws its noise from
  /// normal(seed, i, tick) and its bias from normal(seed, kSensors + i, 0).
  enum : int {
    kGyro = 0,
    kAccelerometer = 3,
    kDisc = 6,
    kGimbals = 7,
    kRotors = kGimbals + model::kMaxGyros,
    kCurrents = kRotors + model::kMaxGyros,
    kVoltage = kCurrents + model::kMaxDrives,
    kLoadCell,
    kSensors
  };
  double told(double truth, int sensor, const Imperfection& imperfection,
              std::int64_t tick) const noexcept;
  sensors_t sample(std::int64_t tick, const model::State& state, const model::Input& input,
                   const model::Truth& truth) const noexcept;
  void sample_imu(std::int64_t tick, const model::State& state, const model::Input& input,
                  sensors_t& sensors) const noexcept;
  void sample_angles(std::int64_t tick, const model::State& state,
                     sensors_t& sensors) const noexcept;
  void sample_drives(std::int64_t tick, const model::Truth& truth,
                     sensors_t& sensors) const noexcept;

  const model::Machine& machine_;
  Rig::Sensors settings_;
  Eigen::Matrix3d to_imu_;                                       // IMU <- structure
  std::array<double, kSensors> bias_{};                          // in units of Imperfection::bias
  std::array<sensors_t, Rig::Sensors::kMaxDelay + 1> measured_;  // a ring
  std::int64_t count_ = 0;                                       // measured since reset()
};

}  // namespace gyrotwin
