#include "services/integrator/simulated_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "services/onboard/noise.hpp"

namespace gyrotwin {

SimulatedSensors::SimulatedSensors(const Rig& rig, const model::Machine& machine)
    : machine_(machine), settings_(*rig.sensors), to_imu_(settings_.imu_axes().transpose()) {
  for (int i = 0; i < kSensors; ++i) {
    bias_[i] = normal(static_cast<std::uint64_t>(settings_.seed),
                      kSensors + static_cast<std::uint64_t>(i), 0);
  }
}

void SimulatedSensors::reset() noexcept { count_ = 0; }

void SimulatedSensors::measure(std::int64_t tick, const model::State& state,
                               const model::Input& input, const model::Truth& truth,
                               sensors_t& sensors) noexcept {
  const auto size = static_cast<std::int64_t>(measured_.size());
  measured_[count_ % size] = sample(tick, state, input, truth);
  const std::int64_t shown = std::max<std::int64_t>(0, count_ - settings_.delay_ticks);
  ++count_;

  sensors_t result = measured_[shown % size];
  result.header = sensors.header;
  std::memcpy(result.mac, sensors.mac, sizeof result.mac);
  sensors = result;
}

double SimulatedSensors::told(double truth, int sensor, const Imperfection& imperfection,
                              std::int64_t tick) const noexcept {
  double value = truth + imperfection.bias * bias_[sensor];
  if (imperfection.noise > 0.0) {
    value += imperfection.noise * normal(static_cast<std::uint64_t>(settings_.seed),
                                         static_cast<std::uint64_t>(sensor),
                                         static_cast<std::uint64_t>(tick));
  }
  if (imperfection.resolution > 0.0) {
    value = imperfection.resolution * std::round(value / imperfection.resolution);
  }
  return value;
}

sensors_t SimulatedSensors::sample(std::int64_t tick, const model::State& state,
                                   const model::Input& input,
                                   const model::Truth& truth) const noexcept {
  sensors_t sensors{};
  sensors.valid |= sensors_t::VALID_ESTOP;  // not pressed
  sample_imu(tick, state, input, sensors);
  sample_angles(tick, state, sensors);
  sample_drives(tick, truth, sensors);
  if (machine_.load_cell) {
    sensors.valid |= sensors_t::VALID_LOAD_CELL;
    sensors.load_cell_n = told(truth.load_cell, kLoadCell, settings_.load_cell, tick);
  }
  return sensors;
}

void SimulatedSensors::sample_imu(std::int64_t tick, const model::State& state,
                                  const model::Input& input, sensors_t& sensors) const noexcept {
  sensors.valid |= sensors_t::VALID_GYRO;
  sensors.valid |= sensors_t::VALID_ACCELEROMETER;
  const model::InertialReading imu = machine_.inertial(state, input, settings_.imu_position);
  const Eigen::Vector3d omega = to_imu_ * imu.angular_velocity;
  const Eigen::Vector3d force = to_imu_ * imu.specific_force;
  for (int i = 0; i < 3; ++i) {
    sensors.gyro_rad_s[i] = told(omega[i], kGyro + i, settings_.gyro, tick);
    sensors.acceleration_m_s2[i] = told(force[i], kAccelerometer + i, settings_.acceleration, tick);
  }
}

void SimulatedSensors::sample_angles(std::int64_t tick, const model::State& state,
                                     sensors_t& sensors) const noexcept {
  const model::Observation seen = machine_.observe(state);
  if (machine_.layout.disc != model::kFixed) {
    sensors.valid |= sensors_t::VALID_DISC;
    sensors.disc_angle_rad = told(seen.disc_angle, kDisc, settings_.disc, tick);
  }
  const int gimbals = static_cast<int>(machine_.layout.gimbals.size());
  if (gimbals > 0) sensors.valid |= sensors_t::VALID_GIMBALS;
  for (int j = 0; j < gimbals; ++j) {
    sensors.gimbal_angle_rad[j] = told(seen.gimbal_angle[j], kGimbals + j, settings_.gimbal, tick);
  }
  if (machine_.rotors > 0) sensors.valid |= sensors_t::VALID_ROTORS;
  for (int j = 0; j < machine_.rotors; ++j) {
    sensors.rotor_speed_rad_s[j] = told(seen.rotor_speed[j], kRotors + j, settings_.rotor, tick);
  }
}

void SimulatedSensors::sample_drives(std::int64_t tick, const model::Truth& truth,
                                     sensors_t& sensors) const noexcept {
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    const model::Drive& drive = machine_.drives[i];
    if (!drive.motor) continue;
    sensors.valid |= sensors_t::VALID_CURRENTS;
    sensors.valid |= sensors_t::VALID_BUS_VOLTAGE;
    const int index = static_cast<int>(i);
    const double current =
        truth.drive_torque[i] / (drive.motor->torque_constant * drive.motor->gear_ratio);
    sensors.drive_current_a[i] = told(current, kCurrents + index, settings_.current, tick);
    sensors.bus_voltage_v = told(drive.motor->supply_voltage, kVoltage, settings_.voltage, tick);
  }
}

}  // namespace gyrotwin
