// What one sensor says in a sensors_t, whichever it is.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>

#include "messages/channels.hpp"

namespace gyrotwin {

/// The channels of one sensor, a VALID_*, in a message; none for the E-stop, which is no number.
/// @param sensors a sensors_t, const or not
template <class Sensors>
auto channels_of(Sensors& sensors, std::int32_t sensor) noexcept {
  using Channels = std::span<std::remove_reference_t<decltype((sensors.disc_angle_rad))>>;
  switch (sensor) {
    case sensors_t::VALID_GYRO:
      return Channels(sensors.gyro_rad_s);
    case sensors_t::VALID_ACCELEROMETER:
      return Channels(sensors.acceleration_m_s2);
    case sensors_t::VALID_DISC:
      return Channels(&sensors.disc_angle_rad, 1);
    case sensors_t::VALID_GIMBALS:
      return Channels(sensors.gimbal_angle_rad);
    case sensors_t::VALID_ROTORS:
      return Channels(sensors.rotor_speed_rad_s);
    case sensors_t::VALID_CURRENTS:
      return Channels(sensors.drive_current_a);
    case sensors_t::VALID_BUS_VOLTAGE:
      return Channels(&sensors.bus_voltage_v, 1);
    case sensors_t::VALID_LOAD_CELL:
      return Channels(&sensors.load_cell_n, 1);
    default:
      return Channels();
  }
}

/// Takes what `from` has of a sensor, validity included, into `to`.
inline void copy_reading(const sensors_t& from, std::int32_t sensor, sensors_t& to) noexcept {
  to.valid = (to.valid & ~sensor) | (from.valid & sensor);
  if (sensor == sensors_t::VALID_ESTOP) to.estop = from.estop;
  std::ranges::copy(channels_of(from, sensor), channels_of(to, sensor).begin());
}

}  // namespace gyrotwin
