// The channels of SENSORS that the filter compares with its model, and how they err.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "messages/channels.hpp"
#include "services/mirror/unknowns.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The sensors of a rig, in the order of the VALID_* bits of sensors_t.
enum Sensor : int {
  kGyro,
  kAccelerometer,
  kDisc,
  kGimbals,
  kRotors,
  kCurrents,
  kBusVoltage,
  kLoadCell,
  kSensors
};
constexpr std::int32_t valid_bit(int sensor) noexcept { return 1 << sensor; }

/// No sensor says more than 1e9, in any unit.
inline bool sane(double reading) noexcept { return std::abs(reading) < 1e9; }

/// The channels of a sensor in a message, and how many a machine has of them.
struct ChannelsOf {
  const double* value;
  int count;
};
ChannelsOf channels_of(const sensors_t& sensors, int sensor,
                       const model::Machine& machine) noexcept;

/// 3 gyro, 3 accelerometer, disc, 4 gimbals, 2 currents, load cell.
inline constexpr int kMaxChannels = 16;
using Channels = std::array<double, kMaxChannels>;

/// One number that the filter uses.
struct Reading {
  int sensor;       ///< Sensor
  int index;        ///< among the sensor's channels
  int bias;         ///< its place in Unknowns; -1: none
  double variance;  ///< of noise and rounding
  double resolution;
  bool rounds;       ///< by more than its noise: equal readings tell nothing new
  int many_repeats;  ///< more on end than noise allows; 0: it has no noise
};

/// All of a rig's, in the order of Sensor.
struct Readings {
  Readings(const Rig& rig, const model::Machine& machine, const Unknowns& unknowns);
  int count = 0;
  std::array<Reading, kMaxChannels> channel{};
};

}  // namespace gyrotwin
