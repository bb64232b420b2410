// What the sensors should say of a state: the model's side of every comparison.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "clients/calibrate/family.hpp"
#include "messages/channels.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::calibration {

/// Sensors that a model can be held against.
enum class SensorKind : std::uint8_t {
  kGyro,
  kAccelerometer,
  kDisc,
  kGimbals,
  kRotors,
  kLoadCell,
};
inline constexpr std::array<std::string_view, 6> kSensorNames{
    "gyro", "accelerometer", "disc", "gimbals", "rotors", "load_cell"};

/// Single readings: gyro and accelerometer x y z, disc, gimbals and rotors 0 to 3, load cell.
inline constexpr int kReadings = 16;
using Readings = Eigen::Matrix<double, kReadings, 1>;

SensorKind kind_of(int reading);
std::string_view unit_of(SensorKind kind);

/// The readings of a message, those that are valid and finite.
std::vector<int> valid_readings(const sensors_t& sensors, const model::Machine& machine);
double reading_of(const sensors_t& sensors, int reading);

/// How far one sample is off, by the rig's [sensors]: noise and rounding to the resolution, at
/// least what makes it a number; and the deviation of what a sensor is off by for good.
struct Uncertainty {
  double sample, bias;
};
Uncertainty uncertainty(const Rig::Sensors& sensors, SensorKind kind);

/// Whether a sample is off by rounding rather than by noise.
bool is_rounded(const Rig::Sensors& sensors, SensorKind kind);

/// @param input that led to the state: an accelerometer feels it
Readings predict(const model::Machine& machine, const model::State& state,
                 const model::Input& input, const Rig::Sensors& sensors);

/// Derivatives by the packed state and by the parameters; by q and q' exactly, but for the load
/// cell, else by central differences.
struct ReadingDerivatives {
  Eigen::MatrixXd by_state, by_parameter;
};
ReadingDerivatives reading_derivatives(const Neighbourhood& around, const model::State& state,
                                       const model::Input& input, const Rig::Sensors& sensors);

}  // namespace gyrotwin::calibration
