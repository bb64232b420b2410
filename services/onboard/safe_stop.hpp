// What the drives do while nobody commands them.
#pragma once

#include <array>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The rig file's safety.safe_stop.
class SafeStop {
 public:
  /// Both outlive it.
  SafeStop(const Rig& rig, const model::Machine& machine) : rig_(rig), machine_(machine) {}

  /// The speeds that `hold_speed` holds are those of now.
  void begin(const model::State& state) noexcept {
    for (std::size_t i = 0; i < machine_.drives.size(); ++i) held_speed_[i] = rate(i, state);
  }

  /// Mode and drives; nothing else acts.
  model::Input input(const model::State& state) const noexcept {
    model::Input input;
    if (rig_.safety.drive == SafeStopDrive::kBrake) {
      input.mode = model::DriveMode::kBrake;
      input.drive.fill(rig_.safety.gain);
    }
    if (rig_.safety.drive == SafeStopDrive::kHoldSpeed) {
      for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
        input.drive[i] = rig_.safety.gain * (held_speed_[i] - rate(i, state));
      }
    }
    return input;
  }

 private:
  double rate(std::size_t drive, const model::State& state) const noexcept {
    return machine_.drive_rate(static_cast<int>(drive), state);
  }

  const Rig& rig_;
  const model::Machine& machine_;
  std::array<double, model::kMaxDrives> held_speed_{};
};

}  // namespace gyrotwin
