#include "services/mirror/readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gyrotwin {

static_assert(valid_bit(kGyro) == sensors_t::VALID_GYRO);
static_assert(valid_bit(kRotors) == sensors_t::VALID_ROTORS);
static_assert(valid_bit(kLoadCell) == sensors_t::VALID_LOAD_CELL);

namespace {

// Of a step of the resolution, where neither noise nor resolution is given: no sensor is perfect.
constexpr double kLeastNoise = 1e-6;

/// Rounding is uniform over a step of the resolution.
double variance_of(const Imperfection& imperfection) {
  const double rounding = imperfection.resolution * imperfection.resolution / 12.0;
  const double variance = imperfection.noise * imperfection.noise + rounding;
  return variance > 0.0 ? variance : kLeastNoise * kLeastNoise;
}

/// The chance that two readings are the same, and how many of them on end are no chance any more.
int many_repeats_of(const Imperfection& imperfection) {
  constexpr double kByChance = 1e-13;
  if (imperfection.noise == 0.0) return 0;
  const double same =
      imperfection.resolution / (2.0 * std::sqrt(std::numbers::pi) * imperfection.noise);
  return std::max(5, static_cast<int>(std::log(kByChance) / std::log(std::clamp(same, 1e-4, 0.9))));
}

}  // namespace

ChannelsOf channels_of(const sensors_t& sensors, int sensor,
                       const model::Machine& machine) noexcept {
  switch (sensor) {
    case kGyro:
      return {sensors.gyro_rad_s, 3};
    case kAccelerometer:
      return {sensors.acceleration_m_s2, 3};
    case kDisc:
      return {&sensors.disc_angle_rad, machine.layout.disc == model::kFixed ? 0 : 1};
    case kGimbals:
      return {sensors.gimbal_angle_rad, static_cast<int>(machine.layout.gimbals.size())};
    case kRotors:
      return {sensors.rotor_speed_rad_s, machine.rotors};
    case kCurrents: {
      int motors = 0;
      for (const model::Drive& drive : machine.drives) motors += drive.motor ? 1 : 0;
      return {sensors.drive_current_a, motors == 0 ? 0 : static_cast<int>(machine.drives.size())};
    }
    case kBusVoltage: {
      bool motors = false;
      for (const model::Drive& drive : machine.drives) motors |= drive.motor.has_value();
      return {&sensors.bus_voltage_v, motors ? 1 : 0};
    }
    default:
      return {&sensors.load_cell_n, machine.load_cell ? 1 : 0};
  }
}

Readings::Readings(const Rig& rig, const model::Machine& machine, const Unknowns& unknowns) {
  const Rig::Sensors& sensors = *rig.sensors;
  const auto add = [this](int sensor, int index, int bias, const Imperfection& imperfection) {
    channel[count++] = {sensor,
                        index,
                        bias,
                        variance_of(imperfection),
                        imperfection.resolution,
                        imperfection.resolution > 2.0 * imperfection.noise,
                        many_repeats_of(imperfection)};
  };
  for (int i = 0; i < 3; ++i) add(kGyro, i, unknowns.gyro_bias[i], sensors.gyro);
  for (int i = 0; i < 3; ++i) {
    add(kAccelerometer, i, unknowns.accelerometer_bias[i], sensors.acceleration);
  }
  if (machine.layout.disc != model::kFixed) add(kDisc, 0, unknowns.disc_bias, sensors.disc);
  for (int j = 0; j < static_cast<int>(machine.layout.gimbals.size()); ++j) {
    add(kGimbals, j, unknowns.gimbal_bias[j], sensors.gimbal);
  }
  for (int i = 0; i < static_cast<int>(machine.drives.size()); ++i) {
    if (machine.drives[i].motor) add(kCurrents, i, unknowns.current_bias[i], sensors.current);
  }
  if (machine.load_cell) add(kLoadCell, 0, unknowns.load_cell_bias, sensors.load_cell);
}

}  // namespace gyrotwin
