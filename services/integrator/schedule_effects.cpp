// What the entries of a schedule do in one tick.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/integrator/schedule.hpp"
#include "services/integrator/sensor_reading.hpp"

namespace gyrotwin {

namespace {

using Eigen::Vector3d;

// Streams of random numbers, clear of those that the simulated sensors draw from one seed.
constexpr std::uint64_t kGustStream = 0x100, kWindStream = 0x200, kSensorStream = 0x300;

std::uint64_t seed_of(const request_t& request) { return static_cast<std::uint64_t>(request.seed); }

Vector3d vector(const double (&x)[3]) { return {x[0], x[1], x[2]}; }

/// Angle [rad] of the chirp after t [s] of T [s].
double chirp_phase(const request_t& r, double t, double T) {
  const double rate = (r.frequency_hz[1] - r.frequency_hz[0]) / T;
  return 2.0 * std::numbers::pi * (r.frequency_hz[0] + 0.5 * rate * t) * t;
}

}  // namespace

void Schedule::apply(std::int64_t tick, model::Input& input) noexcept {
  for (int i = 0; i < count_; ++i) {
    Entry& entry = entries_[i];
    if (!entry.acts(tick)) continue;
    if (entry.disturbs()) {
      disturb(entry, tick, input);
    } else {
      fail(entry.request, input);
    }
  }
  forget([tick](const Entry& entry) { return !entry.on_sensor() && entry.end <= tick + 1; });
}

void Schedule::disturb(Entry& entry, std::int64_t tick, model::Input& input) const noexcept {
  const request_t& r = entry.request;
  const double dt = rig_.loop.tick_s();
  const double t = (static_cast<double>(tick - entry.begin) + 0.5) * dt;  // the tick's middle
  const double rise_s = 1e-9 * static_cast<double>(r.rise_ns);
  const double rise = t < rise_s ? t / rise_s : 1.0;
  const auto load = [&](double strength) {
    input.force += strength * vector(r.force_n);
    input.moment += strength * vector(r.moment_nm);
  };

  switch (r.kind) {
    case request_t::LOAD:
      load(rise);
      break;
    case request_t::SINE:
      load(rise * std::sin(2.0 * std::numbers::pi * r.frequency_hz[0] * t));
      break;
    case request_t::CHIRP:
      load(rise * std::sin(chirp_phase(r, t, static_cast<double>(entry.end - entry.begin) * dt)));
      break;
    case request_t::GUST:
      for (int i = 0; i < 6; ++i) {
        const double rms = i < 3 ? r.force_n[i] : r.moment_nm[i - 3];
        if (rms == 0.0) continue;
        const NoiseSource source{seed_of(r), kGustStream + static_cast<std::uint64_t>(i)};
        const double x =
            entry.gusts[i].next(source, static_cast<std::uint64_t>(tick - entry.begin));
        (i < 3 ? input.force[i] : input.moment[i - 3]) += rise * rms * x;
      }
      break;
    case request_t::WIND:
      blow(entry, tick, rise, input);
      break;
    case request_t::TURN:
      input.yaw_rate += rise * r.yaw_rate_rad_s;
      input.ground_acceleration.y() += rise * r.yaw_rate_rad_s * r.speed_m_s;
      break;
    case request_t::DECELERATION:
      input.ground_acceleration.x() -= rise * r.deceleration_m_s2;
      break;
    case request_t::ADDED_MASS:
      if (input.added.size < model::kMaxAddedMasses) {
        input.added.add({r.mass_kg, vector(r.position_m)});
      }
      break;
  }
}

/// Pressure of the air on the upright structure.
void Schedule::blow(Entry& entry, std::int64_t tick, double rise,
                    model::Input& input) const noexcept {
  const request_t& r = entry.request;
  Vector3d air(r.speed_m_s, 0.0, 0.0);  // along the wind, across it
  if (r.turbulence_m_s != 0.0) {
    const auto index = static_cast<std::uint64_t>(tick - entry.begin);
    air.x() += r.turbulence_m_s * entry.gusts[0].next({seed_of(r), kWindStream}, index);
    air.y() += r.turbulence_m_s * entry.across.next({seed_of(r), kWindStream + 1}, index);
  }
  const Vector3d velocity =
      rise * (Eigen::AngleAxisd(r.direction_rad, Vector3d::UnitZ()) * air).eval();
  const Rig::Wind& body = *rig_.wind;
  const Vector3d force =
      0.5 * Rig::Wind::kAirDensity * body.drag_coefficient * body.area * velocity.norm() * velocity;
  input.force += force;
  const Vector3d arm = Vector3d(0.0, 0.0, body.pressure_height) - machine_.push_point;
  input.moment += arm.cross(force);
}

void Schedule::fail(const request_t& request, model::Input& input) const noexcept {
  const auto hit = [&request](std::size_t index) {
    return request.target == -1 || request.target == static_cast<std::int32_t>(index);
  };
  if (request.kind == request_t::DRIVE_WEAK) {
    for (std::size_t i = 0; i < input.drive_strength.size(); ++i) {
      if (hit(i)) input.drive_strength[i] *= request.level;
    }
  }
  if (request.kind == request_t::ROTOR_LOSS) {
    for (std::size_t j = 0; j < input.rotor_powered.size(); ++j) {
      if (!hit(j)) continue;
      input.rotor_powered[j] = false;
      input.rotor_brake[j] += request.level;
    }
  }
}

void Schedule::corrupt(std::int64_t tick, sensors_t& sensors) noexcept {
  const auto size = static_cast<std::int64_t>(past_.size());
  past_[static_cast<std::size_t>(tick % size)] = sensors;
  for (int i = 0; i < count_; ++i) {
    const request_t& r = entries_[i].request;
    if (!entries_[i].fails(request_t::SENSOR_DELAYED) || !entries_[i].acts(tick)) continue;
    const std::int64_t then = std::max<std::int64_t>(0, tick - to_ticks(r.delay_ns));
    copy_reading(past_[static_cast<std::size_t>(then % size)], r.target, sensors);
  }
  for (int i = 0; i < count_; ++i) {
    if (entries_[i].on_sensor() && entries_[i].acts(tick)) corrupt(entries_[i], tick, sensors);
  }
  forget([tick](const Entry& entry) { return entry.on_sensor() && entry.end <= tick + 1; });
}

void Schedule::corrupt(Entry& entry, std::int64_t tick, sensors_t& sensors) const noexcept {
  const request_t& r = entry.request;
  const auto values = channels_of(sensors, r.target);
  const int count = channels(r.target);
  const bool heard = sensors.valid & r.target;
  switch (r.kind) {
    case request_t::SENSOR_STUCK:
      if (tick == entry.begin) entry.kept = sensors;
      copy_reading(entry.kept, r.target, sensors);
      break;
    case request_t::SENSOR_BIASED:
      for (int i = 0; heard && i < count; ++i) values[i] += r.level;
      break;
    case request_t::SENSOR_NOISY:
      for (int i = 0; heard && i < count; ++i) {
        values[i] += r.level * normal(seed_of(r), kSensorStream + static_cast<std::uint64_t>(i),
                                      static_cast<std::uint64_t>(tick - entry.begin));
      }
      break;
    case request_t::SENSOR_DROPPED:
      copy_reading({}, r.target, sensors);
      break;
    default:  // SENSOR_DELAYED came first
      break;
  }
}

/// How many channels a sensor has on this machine.
int Schedule::channels(std::int32_t sensor) const noexcept {
  switch (sensor) {
    case sensors_t::VALID_GYRO:
    case sensors_t::VALID_ACCELEROMETER:
      return 3;
    case sensors_t::VALID_GIMBALS:
      return static_cast<int>(machine_.layout.gimbals.size());
    case sensors_t::VALID_ROTORS:
      return machine_.rotors;
    case sensors_t::VALID_CURRENTS:
      return static_cast<int>(machine_.drives.size());
    default:
      return 1;
  }
}

}  // namespace gyrotwin
