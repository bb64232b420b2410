// What the drives of a rig exert, as far as its sensors tell.
#pragma once

#include <array>
#include <cmath>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"

namespace gyrotwin {

/// From the motors' currents; where none is heard, what was asked for, within the drives' limits
/// [N m].
/// @param asked mode and drives that act
inline std::array<double, model::kMaxDrives> drive_torques(const model::Machine& machine,
                                                           const model::Observation& seen,
                                                           const sensors_t& sensors,
                                                           const model::Input& asked) noexcept {
  std::array<double, model::kMaxDrives> torque{};
  const model::State state = machine.recall(seen);
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    const model::Drive& drive = machine.drives[i];
    if (drive.motor && (sensors.valid & sensors_t::VALID_CURRENTS) &&
        std::isfinite(sensors.drive_current_a[i])) {
      torque[i] =
          drive.motor->torque_constant * drive.motor->gear_ratio * sensors.drive_current_a[i];
    } else {
      torque[i] =
          drive.torque(asked.mode, asked.drive[i], machine.drive_rate(static_cast<int>(i), state));
    }
  }
  return torque;
}

}  // namespace gyrotwin
