// Runs of a rig, put together from its logs: what the sensors said, and what acted meanwhile.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::calibration {

/// Where the drives' torques are taken from.
enum class DriveSource : std::uint8_t {
  kCommand,  ///< what was commanded, obeyed by the owner's rules
  kCurrent,  ///< what the motors' currents tell
};

/// One tick of a run.
struct Moment {
  std::int64_t tick = 0;
  std::optional<sensors_t> sensors;  ///< of this tick; empty where they were not heard
  model::Input input;                ///< acts until the next tick
  /// DriveSource::kCurrent: of each motor until the next tick [A]; input.drive means nothing then
  std::optional<std::array<double, model::kMaxDrives>> current;
};

/// Ticks without a gap in which everything that acted is known.
struct Stretch {
  std::string file;
  std::int64_t epoch = 0;
  double tick_s = 0.0;
  std::vector<Moment> moments;  ///< the last one's input is unknown and means nothing

  double seconds() const {
    return moments.empty() ? 0.0 : tick_s * static_cast<double>(moments.size() - 1);
  }
};

/// What is known besides what the logs say.
struct Circumstances {
  DriveSource drive = DriveSource::kCommand;
  std::vector<model::PointMass> added{};  ///< bolted to the structure
  double from_s = 0.0, to_s = 1e12;       ///< of each run's own time
};

/// Everything of a log that a model can be held against: RUNNING, and SAFE_STOP where its drives'
/// torque is a function of the state alone. Commands act as the owner let them act, disturbances
/// and drive faults that it applied are part of the input.
/// @param machine the rig's, outlives the call
/// @throws Error when the log is of another rig, has no SENSORS or COMMAND, or nothing moved in it
std::vector<Stretch> read_runs(const std::filesystem::path& log, const Rig& rig,
                               const model::Machine& machine, const Circumstances& circumstances);

}  // namespace gyrotwin::calibration
