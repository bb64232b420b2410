#include "services/onboard/estimator.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

using Eigen::Vector3d;

namespace {

// Sine of the steepest tilt that the accelerometer is believed.
constexpr double kSteepest = 0.9;

// No sensor says more, in any unit: beyond, sums of it might not be finite.
constexpr double kAbsurd = 1e9;

std::optional<double> heard(const sensors_t& sensors, std::int32_t bit, double value) {
  if ((sensors.valid & bit) && std::abs(value) < kAbsurd) return value;
  return std::nullopt;
}

std::optional<Vector3d> heard(const sensors_t& sensors, std::int32_t bit, const double (&xyz)[3]) {
  Vector3d value;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> x = heard(sensors, bit, xyz[i]);
    if (!x) return std::nullopt;
    value[i] = *x;
  }
  return value;
}

/// Tilt rates [rad/s] from the structure's angular velocity in its own axes. A yaw rate of the
/// support, which the gyro feels as well, drops out.
std::array<double, 2> tilt_rates(const Vector3d& omega, const std::array<double, 2>& tilt) {
  const double sx = std::sin(tilt[0]), cx = std::cos(tilt[0]);
  const double sy = std::sin(tilt[1]), cy = std::cos(tilt[1]);
  const double yaw_rate = (omega.z() * cy - omega.x() * sy) / cx;
  return {omega.x() * cy + omega.z() * sy, omega.y() - yaw_rate * sx};
}

}  // namespace

OnboardEstimator::OnboardEstimator(const Rig& rig, const model::Machine& machine)
    : machine_(machine),
      tick_s_(rig.loop.tick_s()),
      coast_ticks_(static_cast<int>(std::ceil(kCoast / tick_s_))),
      tilts_(machine.layout.tilts()),
      from_imu_(rig.sensors->imu_axes()),
      imu_position_(rig.sensors->imu_position),
      tilt_filter_(rig.estimator.tilt, rig.estimator.gyro_bias, tick_s_),
      inclinometer_filter_(kInclinometer, kInclinometer, tick_s_),
      disc_filter_(rig.estimator.disc, rig.estimator.disc, tick_s_),
      gimbal_filter_(rig.estimator.gimbal, rig.estimator.gimbal, tick_s_) {
  reset({});
}

void OnboardEstimator::reset(const model::Observation& seen) noexcept {
  for (int i = 0; i < 2; ++i) {
    tilt_[i] = {seen.tilt[i]};
    inclinometer_[i] = {seen.tilt[i], seen.tilt_rate[i]};
  }
  tilt_known_ = true;
  last_omega_.reset();
  last_rates_.reset();
  disc_ = {seen.disc_angle, seen.disc_rate};
  gimbal_ = {};
  const auto& gimbals = machine_.layout.gimbals;
  for (std::size_t j = 0; j < gimbals.size(); ++j) {
    const auto& [coordinate, coefficient] = gimbals[j];
    gimbal_[coordinate] = {seen.gimbal_angle[j] / coefficient, seen.gimbal_rate[j] / coefficient};
  }

  seen_ = seen;
  valid_ = 0;
  if (tilts_ > 0) valid_ |= state_t::VALID_TILT;
  if (machine_.layout.disc != model::kFixed) valid_ |= state_t::VALID_DISC;
  if (estimate_disc_tilt()) valid_ |= state_t::VALID_DISC_TILT;
  if (!gimbals.empty()) valid_ |= state_t::VALID_GIMBALS;
  if (machine_.rotors > 0) valid_ |= state_t::VALID_ROTORS;
}

void OnboardEstimator::forget() noexcept {
  reset({});
  tilt_known_ = false;
  disc_.silent = coast_ticks_ + 1;
  for (Track& track : inclinometer_) track.silent = coast_ticks_ + 1;
  for (Track& track : gimbal_) track.silent = coast_ticks_ + 1;
  seen_ = {};
  valid_ = 0;
}

void OnboardEstimator::step(const sensors_t& sensors) noexcept {
  seen_ = {};
  valid_ = 0;
  if (estimate_tilt(sensors)) valid_ |= state_t::VALID_TILT;
  if (estimate_disc(sensors)) valid_ |= state_t::VALID_DISC;
  if (estimate_disc_tilt()) valid_ |= state_t::VALID_DISC_TILT;
  if (estimate_gimbals(sensors)) valid_ |= state_t::VALID_GIMBALS;
  if (estimate_rotors(sensors)) valid_ |= state_t::VALID_ROTORS;
}

/// @return false where it was silent for too long
bool OnboardEstimator::follow(const GhFilter& filter, Track& track,
                              std::optional<double> measured) const noexcept {
  const bool lost = track.silent > coast_ticks_;
  if (!measured) {
    if (lost) return false;
    filter.predict(track);
    return ++track.silent <= coast_ticks_;
  }
  if (lost) {
    track = {*measured};
  } else {
    filter.predict(track);
    filter.correct(track, *measured);
    track.silent = 0;
  }
  return true;
}

/// Tilt by gravity's part across the structure: the specific force there less what the motion about
/// the ground pivot accelerates the IMU. The part along the axis says nothing of a small tilt.
std::optional<OnboardEstimator::Tilts> OnboardEstimator::inclination(
    const sensors_t& sensors, const std::optional<Vector3d>& omega) const noexcept {
  const auto force = heard(sensors, sensors_t::VALID_ACCELEROMETER, sensors.acceleration_m_s2);
  if (!force) return std::nullopt;
  Vector3d up = from_imu_ * *force;
  if (omega && last_omega_) {
    const Vector3d alpha = (*omega - *last_omega_) / tick_s_;
    up -= alpha.cross(imu_position_) + omega->cross(omega->cross(imu_position_));
  }
  const double sx = std::clamp(up.y() / machine_.gravity, -kSteepest, kSteepest);
  const double cx = std::sqrt(1.0 - sx * sx);
  const double sy = std::clamp(-up.x() / (machine_.gravity * cx), -kSteepest, kSteepest);
  return Tilts{std::asin(sx), std::asin(sy)};
}

bool OnboardEstimator::estimate_tilt(const sensors_t& sensors) noexcept {
  if (tilts_ == 0) return false;
  auto omega = heard(sensors, sensors_t::VALID_GYRO, sensors.gyro_rad_s);
  if (omega) omega = from_imu_ * *omega;
  const std::optional<Tilts> inclined = inclination(sensors, omega);
  if (omega) {
    tilt_known_ = integrate_gyro(tilt_rates(*omega, {tilt_[0].angle, tilt_[1].angle}), inclined);
  } else {
    last_rates_.reset();
    tilt_known_ = follow_inclination(inclined);
  }
  last_omega_ = omega;
  return tilt_known_;
}

bool OnboardEstimator::integrate_gyro(const Tilts& rates,
                                      const std::optional<Tilts>& inclined) noexcept {
  if (!tilt_known_ && !inclined) return false;
  for (int i = 0; i < tilts_; ++i) {
    Track& tilt = tilt_[i];
    if (tilt_known_) {
      // The mean of two samples: the tilt is as late as the last one, not half a tick more.
      tilt_filter_.predict(tilt, last_rates_ ? 0.5 * (rates[i] + (*last_rates_)[i]) : rates[i]);
      if (inclined) tilt_filter_.correct(tilt, (*inclined)[i]);
    } else {
      tilt.angle = (*inclined)[i];
    }
    seen_.tilt[i] = tilt.angle;
    seen_.tilt_rate[i] = rates[i] + tilt.drift;
    inclinometer_[i] = {seen_.tilt[i], seen_.tilt_rate[i]};
  }
  last_rates_ = rates;
  return true;
}

bool OnboardEstimator::follow_inclination(const std::optional<Tilts>& inclined) noexcept {
  for (int i = 0; i < tilts_; ++i) {
    const auto measured = inclined ? std::optional((*inclined)[i]) : std::nullopt;
    if (!follow(inclinometer_filter_, inclinometer_[i], measured)) return false;
    seen_.tilt[i] = tilt_[i].angle = inclinometer_[i].angle;
    seen_.tilt_rate[i] = inclinometer_[i].drift;
  }
  return true;
}

/// The disc's tilt where the mount decides it; on a universal joint no sensor shows it.
bool OnboardEstimator::estimate_disc_tilt() noexcept {
  const model::Layout& layout = machine_.layout;
  const bool follows = layout.disc_follows_structure;
  seen_.disc_tilt = follows ? seen_.tilt : Tilts{};
  seen_.disc_tilt_rate = follows ? seen_.tilt_rate : Tilts{};
  if (machine_.disc_body == model::kFixed || layout.disc_tilt[0] != model::kFixed) return false;
  return !follows || (valid_ & state_t::VALID_TILT);
}

bool OnboardEstimator::estimate_disc(const sensors_t& sensors) noexcept {
  if (machine_.layout.disc == model::kFixed) return false;
  const auto measured = heard(sensors, sensors_t::VALID_DISC, sensors.disc_angle_rad);
  if (!follow(disc_filter_, disc_, measured)) return false;
  seen_.disc_angle = disc_.angle;
  seen_.disc_rate = disc_.drift;
  return true;
}

/// What the gimbals that share a coordinate say of it, on average.
std::optional<double> OnboardEstimator::measured_gimbal(int coordinate,
                                                        const sensors_t& sensors) const noexcept {
  double sum = 0.0;
  int heard_of = 0;
  const auto& gimbals = machine_.layout.gimbals;
  for (std::size_t j = 0; j < gimbals.size(); ++j) {
    if (gimbals[j].coordinate != coordinate) continue;
    const auto angle = heard(sensors, sensors_t::VALID_GIMBALS, sensors.gimbal_angle_rad[j]);
    if (!angle) continue;
    sum += *angle / gimbals[j].coefficient;
    ++heard_of;
  }
  if (heard_of == 0) return std::nullopt;
  return sum / heard_of;
}

bool OnboardEstimator::estimate_gimbals(const sensors_t& sensors) noexcept {
  bool known = true;
  const auto& gimbals = machine_.layout.gimbals;
  for (int i = 0; i < machine_.coordinates(); ++i) {
    const bool any = std::any_of(gimbals.begin(), gimbals.end(),
                                 [i](const auto& gimbal) { return gimbal.coordinate == i; });
    if (any) known &= follow(gimbal_filter_, gimbal_[i], measured_gimbal(i, sensors));
  }
  if (!known) return false;
  for (std::size_t j = 0; j < gimbals.size(); ++j) {
    const auto& [coordinate, coefficient] = gimbals[j];
    seen_.gimbal_angle[j] = coefficient * gimbal_[coordinate].angle;
    seen_.gimbal_rate[j] = coefficient * gimbal_[coordinate].drift;
  }
  return true;
}

bool OnboardEstimator::estimate_rotors(const sensors_t& sensors) noexcept {
  for (int j = 0; j < machine_.rotors; ++j) {
    const auto speed = heard(sensors, sensors_t::VALID_ROTORS, sensors.rotor_speed_rad_s[j]);
    if (!speed) {
      seen_.rotor_speed = {};
      return false;
    }
    seen_.rotor_speed[j] = *speed;
  }
  return machine_.rotors > 0;
}

}  // namespace gyrotwin
