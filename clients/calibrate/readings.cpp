#include "clients/calibrate/readings.hpp"

#include <algorithm>
#include <cmath>

#include "services/integrator/plant.hpp"
#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"

namespace gyrotwin::calibration {

namespace {

enum : int { kGyro = 0, kAcceleration = 3, kDisc = 6, kGimbals = 7, kRotors = 11, kCell = 15 };

constexpr double kAngleStep = 1e-6;  // of q and q' where they are differenced [rad], [rad/s]
constexpr double kRotorStep = 1e-2;  // [rad/s]

/// Gyro and accelerometer, IMU axes.
template <class S>
std::array<S, 6> inertial(const model::Machine& machine, const model::StateOf<S>& state,
                          const model::Input& input, const model::RotorSpeeds& rotor_rate,
                          const Rig::Sensors& sensors) {
  model::MotionOf<S> motion;
  const model::CoordinatesOf<S> acceleration =
      model::accelerate(machine, state, input, rotor_rate, motion);
  const model::StructurePoint<S> imu =
      model::structure_point(machine, motion, sensors.imu_position);
  model::Vector3<S> a = imu.a0;
  for (int i = 0; i < machine.coordinates(); ++i) a += imu.J[i] * acceleration[i];
  const Eigen::Matrix<S, 3, 3> to_imu =
      Eigen::Matrix3d(sensors.imu_axes().transpose()).template cast<S>();
  const model::Vector3<S> omega = to_imu * motion.frame[0].omega;
  const model::Vector3<S> force = to_imu * a;
  return {omega[0], omega[1], omega[2], force[0], force[1], force[2]};
}

double load_cell(const model::Machine& machine, const model::State& state,
                 const model::Input& input) {
  model::Motion motion;
  model::evaluate(machine, state, input, {}, motion);
  return model::load_cell_force(machine, motion, input);
}

/// Angles and rotor speeds, which are linear in the state.
void add_angles(const model::Machine& machine, const model::State& state, Readings& r) {
  const model::Observation seen = machine.observe(state);
  r[kDisc] = seen.disc_angle;
  for (int j = 0; j < model::kMaxGyros; ++j) {
    r[kGimbals + j] = seen.gimbal_angle[static_cast<std::size_t>(j)];
    r[kRotors + j] = seen.rotor_speed[static_cast<std::size_t>(j)];
  }
}

void differentiate_exactly(const model::Machine& machine, const model::State& state,
                           const model::Input& input, const Rig::Sensors& sensors,
                           Eigen::MatrixXd& by_state) {
  const int n = machine.coordinates();
  const model::RotorSpeeds rotor_rate = machine.rotor_acceleration(state, input);
  model::StateOf<model::Dual> moved{state.q.cast<model::Dual>(), state.v.cast<model::Dual>(),
                                    state.rotor_speed};
  for (int j = 0; j < 2 * n; ++j) {
    model::Dual& direction = j < n ? moved.q[j] : moved.v[j - n];
    direction.slope = 1.0;
    const auto imu = inertial(machine, moved, input, rotor_rate, sensors);
    direction.slope = 0.0;
    for (int i = 0; i < 6; ++i) by_state(i, j) = imu[static_cast<std::size_t>(i)].slope;
  }
  if (machine.layout.disc != model::kFixed) by_state(kDisc, machine.layout.disc) = 1.0;
  for (std::size_t j = 0; j < machine.layout.gimbals.size(); ++j) {
    const model::Layout::Gimbal& gimbal = machine.layout.gimbals[j];
    by_state(kGimbals + static_cast<int>(j), gimbal.coordinate) = gimbal.coefficient;
  }
}

}  // namespace

SensorKind kind_of(int reading) {
  if (reading < kAcceleration) return SensorKind::kGyro;
  if (reading < kDisc) return SensorKind::kAccelerometer;
  if (reading < kGimbals) return SensorKind::kDisc;
  if (reading < kRotors) return SensorKind::kGimbals;
  return reading < kCell ? SensorKind::kRotors : SensorKind::kLoadCell;
}

std::string_view unit_of(SensorKind kind) {
  constexpr std::array<std::string_view, 6> kUnits{"rad/s", "m/s^2", "rad", "rad", "rad/s", "N"};
  return kUnits[static_cast<std::size_t>(kind)];
}

std::vector<int> valid_readings(const sensors_t& sensors, const model::Machine& machine) {
  std::vector<int> valid;
  const auto add = [&](std::int32_t bit, int first, int count) {
    if ((sensors.valid & bit) == 0) return;
    for (int i = first; i < first + count; ++i) {
      if (std::isfinite(reading_of(sensors, i))) valid.push_back(i);
    }
  };
  add(sensors_t::VALID_GYRO, kGyro, 3);
  add(sensors_t::VALID_ACCELEROMETER, kAcceleration, 3);
  if (machine.layout.disc != model::kFixed) add(sensors_t::VALID_DISC, kDisc, 1);
  add(sensors_t::VALID_GIMBALS, kGimbals, static_cast<int>(machine.layout.gimbals.size()));
  if (machine.rotor_drive) add(sensors_t::VALID_ROTORS, kRotors, machine.rotors);
  if (machine.load_cell) add(sensors_t::VALID_LOAD_CELL, kCell, 1);
  return valid;
}

double reading_of(const sensors_t& sensors, int reading) {
  switch (kind_of(reading)) {
    case SensorKind::kGyro:
      return sensors.gyro_rad_s[reading - kGyro];
    case SensorKind::kAccelerometer:
      return sensors.acceleration_m_s2[reading - kAcceleration];
    case SensorKind::kDisc:
      return sensors.disc_angle_rad;
    case SensorKind::kGimbals:
      return sensors.gimbal_angle_rad[reading - kGimbals];
    case SensorKind::kRotors:
      return sensors.rotor_speed_rad_s[reading - kRotors];
    case SensorKind::kLoadCell:
      break;
  }
  return sensors.load_cell_n;
}

namespace {

const Imperfection& imperfection(const Rig::Sensors& sensors, SensorKind kind) {
  const std::array<const Imperfection*, 6> all{&sensors.gyro,  &sensors.acceleration,
                                               &sensors.disc,  &sensors.gimbal,
                                               &sensors.rotor, &sensors.load_cell};
  return *all[static_cast<std::size_t>(kind)];
}

}  // namespace

Uncertainty uncertainty(const Rig::Sensors& sensors, SensorKind kind) {
  // Of a sensor that the rig file calls perfect.
  constexpr std::array<double, 6> kLeast{1e-4, 1e-3, 1e-5, 1e-5, 1e-2, 1e-3};
  const Imperfection& off = imperfection(sensors, kind);
  const double rounding = off.resolution / std::sqrt(12.0);
  return {std::max(std::hypot(off.noise, rounding), kLeast[static_cast<std::size_t>(kind)]),
          off.bias};
}

bool is_rounded(const Rig::Sensors& sensors, SensorKind kind) {
  const Imperfection& off = imperfection(sensors, kind);
  return off.noise < 0.5 * off.resolution;
}

Readings predict(const model::Machine& machine, const model::State& state,
                 const model::Input& input, const Rig::Sensors& sensors) {
  Readings r = Readings::Zero();
  const auto imu =
      inertial(machine, state, input, machine.rotor_acceleration(state, input), sensors);
  std::copy(imu.begin(), imu.end(), r.data());
  add_angles(machine, state, r);
  if (machine.load_cell) r[kCell] = load_cell(machine, state, input);
  return r;
}

ReadingDerivatives reading_derivatives(const Neighbourhood& around, const model::State& state,
                                       const model::Input& input, const Rig::Sensors& sensors) {
  const model::Machine& machine = around.machine;
  const int n = machine.coordinates();
  const int size = packed_size(machine);
  ReadingDerivatives d{Eigen::MatrixXd::Zero(kReadings, size),
                       Eigen::MatrixXd(kReadings, static_cast<Eigen::Index>(around.pairs.size()))};
  differentiate_exactly(machine, state, input, sensors, d.by_state);

  Eigen::VectorXd y(size);
  pack(machine, state, y.data());
  const auto differ = [&](int j, double step, auto&& quantity) {
    const double before = y[j];
    y[j] = before + step;
    const auto up = quantity(unpack(machine, y.data(), state.rotor_speed));
    y[j] = before - step;
    const auto down = quantity(unpack(machine, y.data(), state.rotor_speed));
    y[j] = before;
    return decltype(up)((up - down) / (2.0 * step));
  };
  for (int j = 2 * n; j < size; ++j) {
    d.by_state.col(j) = differ(j, kRotorStep, [&](const model::State& at) -> Readings {
      return predict(machine, at, input, sensors);
    });
  }
  for (int j = 0; machine.load_cell && j < 2 * n; ++j) {
    d.by_state(kCell, j) = differ(
        j, kAngleStep, [&](const model::State& at) { return load_cell(machine, at, input); });
  }
  for (std::size_t i = 0; i < around.pairs.size(); ++i) {
    const auto& [up, down, span] = around.pairs[i];
    d.by_parameter.col(static_cast<Eigen::Index>(i)) =
        (predict(up, state, input, sensors) - predict(down, state, input, sensors)) / span;
  }
  return d;
}

}  // namespace gyrotwin::calibration
