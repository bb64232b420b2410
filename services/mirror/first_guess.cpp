#include "services/mirror/first_guess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/mirror/readings.hpp"

namespace gyrotwin {

using Eigen::Vector3d;

namespace {

// Uncertainty beside what the sensors say: rates of gimbals and disc [rad/s], tilts [rad]; at rest,
// and on top for each rad/s that the gyro says, or as for 1 rad/s under way.
struct Width {
  double gimbal_rate, disc_rate, tilt, disc_tilt, disc_tilt_rate;
};
constexpr Width kAtRest{0.1, 1.0, 2e-3, 0.02, 0.1}, kMoving{10.0, 10.0, 0.3, 0.3, 1.0};

constexpr double kTiltRate = 0.1;  // what contact does at once where the tilt is not quite right
constexpr double kMoves = 8.0;     // sigmas of a gyro

bool heard(const sensors_t& sensors, Sensor sensor, double value) {
  return (sensors.valid & valid_bit(sensor)) && sane(value);
}

/// A sensor's numbers, where all are heard.
std::optional<Vector3d> vector_of(const sensors_t& sensors, Sensor sensor, const double (&x)[3]) {
  for (const double value : x) {
    if (!heard(sensors, sensor, value)) return std::nullopt;
  }
  return Vector3d(x[0], x[1], x[2]);
}

/// Tilts that turn z into that direction of the structure's frame.
std::array<double, 2> tilts_of(const Vector3d& up) {
  const double sx = std::clamp(up.y(), -0.9, 0.9);
  const double sy = std::clamp(-up.x() / std::sqrt(1.0 - sx * sx), -0.9, 0.9);
  return {std::asin(sx), std::asin(sy)};
}

}  // namespace

FirstGuess first_guess(const Rig& rig, const model::Machine& machine,
                       const sensors_t& first) noexcept {
  const Rig::Sensors& sensors = *rig.sensors;
  const model::Layout& layout = machine.layout;
  const int n = machine.coordinates();

  const double gyro_sigma =
      std::max(std::hypot(sensors.gyro.noise, sensors.gyro.bias, sensors.gyro.resolution), 1e-6);
  const Vector3d omega =
      sensors.imu_axes() * vector_of(first, kGyro, first.gyro_rad_s).value_or(Vector3d::Zero());
  const bool moves = omega.norm() > kMoves * gyro_sigma;
  // Under way it may be anywhere in a swing, even where the gyro says nothing.
  const bool under_way = first.header.tick > 0;
  const double turning = under_way ? 1.0 : moves ? std::min(omega.norm(), 1.0) : 0.0;
  const auto width = [turning](double Width::*of) { return kAtRest.*of + turning * kMoving.*of; };
  // Gravity across the structure. In a swing the accelerometer feels more than that.
  std::optional<Vector3d> up;
  if (!under_way) up = vector_of(first, kAccelerometer, first.acceleration_m_s2);
  const double up_sigma =
      std::hypot(sensors.acceleration.noise, sensors.acceleration.bias) / machine.gravity;

  FirstGuess guess{rig.initial_state(machine),
                   Prediction::Point::Constant(2 * n, width(&Width::gimbal_rate))};
  auto& [state, sigma] = guess;
  std::array<double, 2> tilts{};
  if (up) tilts = tilts_of(sensors.imu_axes() * *up / machine.gravity);
  for (int i = 0; i < 2; ++i) {
    const int tilt = layout.tilt[i], disc_tilt = layout.disc_tilt[i];
    if (tilt == model::kFixed) continue;
    if (up) state.q[tilt] = tilts[i];
    if (moves) state.v[tilt] = omega[i];
    // The IMU feels what the tilt would do if it were let go: a tenth of it is left to doubt.
    sigma[tilt] = std::hypot(up_sigma, width(&Width::tilt), 0.1 * state.q[tilt]);
    sigma[n + tilt] = kTiltRate + 0.1 * turning;
    if (disc_tilt == model::kFixed) continue;
    if (up) state.q[disc_tilt] = tilts[i];
    if (moves) state.v[disc_tilt] = omega[i];
    sigma[disc_tilt] = width(&Width::disc_tilt);
    sigma[n + disc_tilt] = width(&Width::disc_tilt_rate);
  }
  if (const int disc = layout.disc; disc != model::kFixed) {
    if (heard(first, kDisc, first.disc_angle_rad)) state.q[disc] = first.disc_angle_rad;
    sigma[disc] = std::hypot(sensors.disc.noise, sensors.disc.resolution, 1e-6);
    sigma[n + disc] = width(&Width::disc_rate);
  }
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t j = 0; j < layout.gimbals.size(); ++j) {
      if (layout.gimbals[j].coordinate != i) continue;
      sigma[i] = std::hypot(sensors.gimbal.noise, sensors.gimbal.resolution, sensors.gimbal.bias);
      if (!heard(first, kGimbals, first.gimbal_angle_rad[j])) continue;
      sum += first.gimbal_angle_rad[j] / layout.gimbals[j].coefficient;
      ++count;
    }
    if (count > 0) state.q[i] = sum / count;
  }
  return guess;
}

}  // namespace gyrotwin
