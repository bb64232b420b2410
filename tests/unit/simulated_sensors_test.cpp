// Simulated sensors: the truth where nothing is imperfect, and each imperfection by itself.
#include "services/integrator/simulated_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

constexpr double kPi = std::numbers::pi;

/// A rig with sensors that are perfect until a test spoils them.
struct Bench {
  explicit Bench(const std::string& name = "prototype_b")
      : rig(load_rig(name)), machine(rig.build_machine()), state(rig.initial_state(machine)) {
    rig.sensors.emplace();
  }

  /// What one sensor says in ticks 0, 1, ...
  template <class Pick>
  std::vector<double> series(int ticks, Pick&& pick) const {
    SimulatedSensors simulated(rig, machine);
    sensors_t sensors{};
    std::vector<double> values;
    for (int tick = 0; tick < ticks; ++tick) {
      simulated.measure(tick, state, input, truth(), sensors);
      values.push_back(pick(sensors));
    }
    return values;
  }
  model::Truth truth() const { return machine.truth(state, input); }
  sensors_t first() const {
    SimulatedSensors simulated(rig, machine);
    sensors_t sensors{};
    simulated.measure(0, state, input, truth(), sensors);
    return sensors;
  }

  Rig rig;
  model::Machine machine;
  model::State state;
  model::Input input;
};

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

/// Mean of (x - mean) (y - mean), y shifted by `lag`.
double covariance(const std::vector<double>& x, const std::vector<double>& y, std::size_t lag = 0) {
  const double mx = mean(x), my = mean(y);
  double sum = 0.0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) sum += (x[i] - mx) * (y[i + lag] - my);
  return sum / static_cast<double>(x.size() - lag);
}

double gyro_x(const sensors_t& sensors) { return sensors.gyro_rad_s[0]; }

TEST(SimulatedSensors, TellTheTruthWhenPerfect) {
  Bench bench;
  bench.state.q << 0.1, -0.2, 7.0, 0.03, 0.0, 0.0;
  bench.state.v << 0.3, 0.4, -5.0, 0.6, 0.0, 0.0;
  bench.input.drive[0] = 3.0;
  bench.rig.sensors->imu_position = {0.01, 0.02, 0.3};
  const sensors_t told = bench.first();
  const auto imu = bench.machine.inertial(bench.state, bench.input, {0.01, 0.02, 0.3});
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(told.gyro_rad_s[i], imu.angular_velocity[i]);
    EXPECT_EQ(told.acceleration_m_s2[i], imu.specific_force[i]);
  }
  EXPECT_EQ(told.disc_angle_rad, 7.0);
  for (double angle : told.gimbal_angle_rad) EXPECT_EQ(angle, 0.03);
  for (double speed : told.rotor_speed_rad_s) EXPECT_EQ(speed, 400.0 * kPi);
  EXPECT_DOUBLE_EQ(told.drive_current_a[0], 3.0 / (0.05 * 12.0));
  EXPECT_EQ(told.drive_current_a[1], 0.0);
  EXPECT_EQ(told.bus_voltage_v, 24.0);
  EXPECT_EQ(told.estop, 0);
}

TEST(SimulatedSensors, CurrentIsThatOfTheTorqueThatArrives) {
  Bench bench;
  bench.input.drive[0] = 1000.0;  // the rig's limit: 12 N m
  EXPECT_DOUBLE_EQ(bench.first().drive_current_a[0], 20.0);
  bench.input.drive_strength[0] = 0.25;
  EXPECT_DOUBLE_EQ(bench.first().drive_current_a[0], 5.0);
}

TEST(SimulatedSensors, AreValidWhereTheMachineHasThem) {
  std::int32_t imu = 0, umbrella = 0;
  for (int bit :
       {sensors_t::VALID_GYRO + 0, sensors_t::VALID_ACCELEROMETER + 0, sensors_t::VALID_GIMBALS + 0,
        sensors_t::VALID_ROTORS + 0, sensors_t::VALID_ESTOP + 0}) {
    imu |= bit;
  }
  umbrella = imu | sensors_t::VALID_DISC;
  umbrella |= sensors_t::VALID_CURRENTS;
  umbrella |= sensors_t::VALID_BUS_VOLTAGE;
  EXPECT_EQ(Bench("prototype_b").first().valid, umbrella);
  EXPECT_EQ(Bench("brennan_monorail").first().valid, imu);

  Bench held;
  held.machine.load_cell =
      model::LoadCell{{0.0, 0.0, 0.3}, {0.0, -1.0, 0.0}, 1e6, 0.0};  // pressed by roll > 0
  EXPECT_EQ(held.first().valid, umbrella | sensors_t::VALID_LOAD_CELL);
  EXPECT_EQ(held.first().load_cell_n, held.machine.truth(held.state, held.input).load_cell);
  EXPECT_GT(held.first().load_cell_n, 1000.0);
}

// On its side: what the structure has along y, the IMU has along its x; z stays.
TEST(SimulatedSensors, MountingTurnsTheAxesOfTheImu) {
  Bench bench;
  bench.state.q.setZero();
  bench.state.v.setZero();
  bench.state.v[1] = 0.4;
  bench.rig.sensors->imu_orientation = {0.0, 0.0, kPi / 2};
  const sensors_t told = bench.first();
  EXPECT_NEAR(told.gyro_rad_s[0], 0.4, 1e-15);  // measured exact
  EXPECT_NEAR(told.gyro_rad_s[1], 0.0, 1e-15);  // measured 8.9e-17
  EXPECT_NEAR(told.acceleration_m_s2[2], 9.81, 1e-12);
}

TEST(SimulatedSensors, OrientationIsRxRyRz) {
  Rig::Sensors sensors;
  sensors.imu_orientation = {0.1, 0.2, 0.3};
  const Eigen::Vector3d z = sensors.imu_axes() * Eigen::Vector3d::UnitZ();
  // The last turn leaves z; Ry takes it to (sin, 0, cos), Rx turns that about x.
  EXPECT_NEAR(z.x(), std::sin(0.2), 1e-15);
  EXPECT_NEAR(z.y(), -std::sin(0.1) * std::cos(0.2), 1e-15);
  EXPECT_NEAR(z.z(), std::cos(0.1) * std::cos(0.2), 1e-15);
}

TEST(SimulatedSensors, NoiseIsWhiteAndOfItsSize) {
  Bench bench;
  bench.rig.sensors->gyro.noise = 0.01;
  bench.rig.sensors->gimbal.noise = 0.002;
  const double rate = bench.state.v[0];
  const auto x = bench.series(20000, gyro_x);
  const auto y = bench.series(20000, [](const sensors_t& s) { return s.gyro_rad_s[1]; });
  const auto gimbal = bench.series(20000, [](const sensors_t& s) { return s.gimbal_angle_rad[3]; });
  // 4 standard deviations of each figure, for 20000 independent draws.
  EXPECT_NEAR(mean(x), rate, 2.9e-4);                               // measured 1.4e-4
  EXPECT_NEAR(std::sqrt(covariance(x, x)), 0.01, 2e-4);             // measured 0.00986
  EXPECT_NEAR(std::sqrt(covariance(gimbal, gimbal)), 0.002, 4e-5);  // measured 0.001993
  EXPECT_NEAR(covariance(x, x, 1) / 1e-4, 0.0, 0.029);              // measured 0.011
  EXPECT_NEAR(covariance(x, y) / 1e-4, 0.0, 0.029);                 // measured 0.0062
  EXPECT_NEAR(covariance(x, gimbal) / (0.01 * 0.002), 0.0, 0.029);  // measured 0.0026
}

TEST(SimulatedSensors, BiasIsDrawnOncePerSensorFromTheSeed) {
  Bench bench;
  bench.rig.sensors->gyro.bias = 0.02;
  bench.rig.sensors->acceleration.bias = 0.5;
  bench.state.v.setZero();
  std::vector<double> biases;
  for (int seed = 0; seed < 2000; ++seed) {
    bench.rig.sensors->seed = seed;
    const auto told = bench.series(3, gyro_x);
    EXPECT_EQ(told[0], told[2]);
    biases.push_back(told[0]);
  }
  EXPECT_NEAR(mean(biases), 0.0, 1.8e-3);                            // 4 sigma; measured 8.6e-4
  EXPECT_NEAR(std::sqrt(covariance(biases, biases)), 0.02, 1.3e-3);  // 4 sigma; measured 0.0193
  const sensors_t told = bench.first();
  EXPECT_NE(told.gyro_rad_s[0], told.gyro_rad_s[1]);
  EXPECT_NE(told.gyro_rad_s[0] / 0.02, told.acceleration_m_s2[0] / 0.5);
}

TEST(SimulatedSensors, ResolutionRoundsToTheNearestStep) {
  Bench bench;
  bench.rig.sensors->disc.resolution = 0.25;
  for (const auto& [angle, told] :
       {std::pair{0.12, 0.0}, {0.13, 0.25}, {-0.13, -0.25}, {100.4, 100.5}}) {
    bench.state.q[2] = angle;
    EXPECT_EQ(bench.first().disc_angle_rad, told) << angle;
  }
}

TEST(SimulatedSensors, DelayShowsWhatWasMeasuredThen) {
  Bench bench;
  bench.rig.sensors->delay_ticks = 3;
  SimulatedSensors simulated(bench.rig, bench.machine);
  sensors_t sensors{};
  for (int run = 0; run < 2; ++run) {
    for (int tick = 0; tick < 30; ++tick) {
      bench.state.q[2] = 100.0 * run + tick;
      simulated.measure(tick, bench.state, bench.input, bench.truth(), sensors);
      EXPECT_EQ(sensors.disc_angle_rad, 100.0 * run + std::max(0, tick - 3));
    }
    simulated.reset();
  }
}

TEST(SimulatedSensors, NoiseIsTheSameInEveryRun) {
  Bench bench;
  bench.rig = load_rig("prototype_b");
  const auto once = bench.series(100, gyro_x);
  EXPECT_EQ(bench.series(100, gyro_x), once);

  SimulatedSensors simulated(bench.rig, bench.machine);
  sensors_t sensors{};
  simulated.measure(57, bench.state, bench.input, bench.truth(), sensors);  // whatever came before
  EXPECT_EQ(gyro_x(sensors), once[57]);

  bench.rig.sensors->seed += 1;
  EXPECT_NE(bench.series(100, gyro_x), once);
}

TEST(SimulatedSensors, LeaveHeaderAndMacAndTheHeapAlone) {
  Bench bench;
  SimulatedSensors simulated(bench.rig, bench.machine);
  sensors_t sensors{};
  sensors.header.sequence = 17;
  sensors.mac[5] = 9;
  const AllocationCounter allocations;
  for (int tick = 0; tick < 10; ++tick) {
    simulated.measure(tick, bench.state, bench.input, bench.truth(), sensors);
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(sensors.header.sequence, 17);
  EXPECT_EQ(sensors.mac[5], 9);
}

}  // namespace
}  // namespace gyrotwin
