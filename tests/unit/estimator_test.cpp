// The onboard estimator on readings made by hand: attitude, biases, rates, and doing without.
#include "services/onboard/estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "services/onboard/noise.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int32_t kImu = 3;  // VALID_GYRO and VALID_ACCELEROMETER

/// A platform that moves as a test says, and perfect sensors on it.
struct Bench {
  explicit Bench(const std::string& name = "prototype_b",
                 const std::vector<std::string>& overrides = {})
      : rig(load_rig(name, overrides)), machine(rig.build_machine()), estimator(rig, machine) {
    sensors.valid = 0x1ff;
    for (double& speed : sensors.rotor_speed_rad_s) speed = 100.0;
  }

  /// What an IMU at imu_position reads at these tilts, rates and accelerations, the support turning
  /// at `yaw_rate`.
  void move(std::array<double, 2> q, std::array<double, 2> v, std::array<double, 2> a,
            double yaw_rate = 0.0) {
    const auto R = [&](double t) {
      const auto at = [&](int i) { return q[i] + v[i] * t + 0.5 * a[i] * t * t; };
      return Eigen::Matrix3d((Eigen::AngleAxisd(yaw_rate * t, Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(at(0), Vector3d::UnitX()) *
                              Eigen::AngleAxisd(at(1), Vector3d::UnitY()))
                                 .toRotationMatrix());
    };
    constexpr double h = 1e-4;
    const Eigen::Matrix3d spin = R(0).transpose() * (R(h) - R(-h)) / (2.0 * h);
    const Vector3d omega(spin(2, 1), spin(0, 2), spin(1, 0));
    const Vector3d acceleration = (R(h) - 2.0 * R(0) + R(-h)) / (h * h) * rig.sensors->imu_position;
    const Eigen::Matrix3d to_imu = rig.sensors->imu_axes().transpose();
    const Vector3d force = R(0).transpose() * (acceleration + Vector3d(0.0, 0.0, machine.gravity));
    Vector3d::Map(sensors.gyro_rad_s) = to_imu * (omega + gyro_bias);
    Vector3d::Map(sensors.acceleration_m_s2) = to_imu * force;
    true_tilt = q;
  }
  void rest(std::array<double, 2> q) { move(q, {}, {}); }

  void step(double seconds) {
    const auto n = std::llround(seconds * rig.loop.rate_hz);
    for (std::int64_t i = 0; i < n; ++i) estimator.step(sensors);
  }
  double error() const {
    const auto& tilt = estimator.seen().tilt;
    return std::hypot(tilt[0] - true_tilt[0], tilt[1] - true_tilt[1]);
  }
  bool knows(std::int32_t group) const { return estimator.valid() & group; }

  Rig rig;
  model::Machine machine;
  OnboardEstimator estimator;
  sensors_t sensors{};
  Vector3d gyro_bias = Vector3d::Zero();
  std::array<double, 2> true_tilt{};
};

bool finite(const model::Observation& seen) {
  double sum = seen.disc_angle + seen.disc_rate;
  for (int i = 0; i < 2; ++i) {
    sum += seen.tilt[i] + seen.tilt_rate[i] + seen.disc_tilt[i] + seen.disc_tilt_rate[i];
  }
  for (int j = 0; j < model::kMaxGyros; ++j) {
    sum += seen.gimbal_angle[j] + seen.gimbal_rate[j] + seen.rotor_speed[j];
  }
  return std::isfinite(sum);
}

// ---- attitude

TEST(Tilt, ComesFromGravityAtItsBandwidth) {
  Bench bench;
  bench.rest({0.1, -0.05});
  bench.step(1.0);
  // Poles -1 and -0.1: the error overshoots a little, as the gyro is suspected for a while.
  EXPECT_LT(bench.error(), 0.45 * std::hypot(0.1, 0.05));  // measured 0.31
  bench.step(60.0);
  EXPECT_LT(bench.error(), 2e-4);  // measured 2.8e-5
}

TEST(Tilt, GyroBiasIsLearned) {
  Bench bench;
  bench.gyro_bias = {0.01, -0.02, 0.03};
  bench.rest({0.02, 0.01});
  bench.estimator.reset({.tilt = {0.02, 0.01}});
  double worst = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    bench.step(0.001);
    worst = std::max(worst, bench.error());
  }
  // Bias over the bandwidth is what a filter without learning would be off by: 0.022 rad.
  EXPECT_LT(worst, 0.02);                                       // measured 0.0178
  EXPECT_LT(bench.error(), 2e-4);                               // measured 6.9e-5
  EXPECT_NEAR(bench.estimator.seen().tilt_rate[0], 0.0, 2e-4);  // measured 3.7e-5
  EXPECT_NEAR(bench.estimator.seen().tilt_rate[1], 0.0, 2e-4);  // measured 5.2e-5
}

/// Largest error [rad] and rate error [rad/s] of 20 s of swinging on both axes.
std::array<double, 2> swing(Bench& bench, double amplitude, double yaw_rate) {
  const double w[2] = {3.0, 4.3};
  std::array<double, 2> worst{};
  for (int k = 0; k <= 20'000; ++k) {
    const double t = 0.001 * k;
    std::array<double, 2> q, v, a;
    for (int i = 0; i < 2; ++i) {
      q[i] = amplitude * std::sin(w[i] * t);
      v[i] = amplitude * w[i] * std::cos(w[i] * t);
      a[i] = -amplitude * w[i] * w[i] * std::sin(w[i] * t);
    }
    bench.move(q, v, a, yaw_rate);
    if (k == 0) {
      bench.estimator.reset({});
      continue;
    }
    bench.step(0.001);
    worst[0] = std::max(worst[0], bench.error());
    const auto& rate = bench.estimator.seen().tilt_rate;
    worst[1] = std::max(worst[1], std::hypot(rate[0] - v[0], rate[1] - v[1]));
  }
  return worst;
}

TEST(Tilt, FollowsLargeMotionOnAYawingSupportByTheGyroAlone) {
  Bench bench;
  bench.sensors.valid &= ~sensors_t::VALID_ACCELEROMETER;
  const auto [angle, rate] = swing(bench, 0.5, 0.7);
  EXPECT_LT(angle, 2e-3);  // measured 1.05e-3
  EXPECT_LT(rate, 5e-3);   // measured 2.7e-3
}

TEST(Tilt, MotionOfTheImuIsTakenFromItsAcceleration) {
  const std::string high = "sensors.imu_position_m=[0.0, 0.0, 0.5]";
  Bench bench("prototype_b", {high});
  EXPECT_LT(swing(bench, 0.2, 0.0)[0], 1e-3);  // measured 1.2e-4

  // One that is told that the IMU sits at the pivot takes its motion for tilt.
  Bench told_wrong("prototype_b", {high});
  Rig wrong = told_wrong.rig;
  wrong.sensors->imu_position.setZero();
  std::destroy_at(&told_wrong.estimator);
  std::construct_at(&told_wrong.estimator, wrong, told_wrong.machine);
  EXPECT_GT(swing(told_wrong, 0.2, 0.0)[0], 2e-2);  // measured 0.085
}

TEST(Tilt, DoesNotDependOnHowTheImuIsMounted) {
  Bench straight, turned("prototype_b", {"sensors.imu_orientation_rad=[1.0, -0.6, 2.5]"});
  for (Bench* bench : {&straight, &turned}) {
    bench->move({0.1, 0.2}, {0.3, -0.4}, {});
    bench->step(0.5);
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(straight.estimator.seen().tilt[i], turned.estimator.seen().tilt[i], 1e-12);
    EXPECT_NEAR(straight.estimator.seen().tilt_rate[i], turned.estimator.seen().tilt_rate[i],
                1e-12);
  }
}

TEST(Tilt, OfARailVehicleIsRollAlone) {
  Bench bench("brennan_monorail");
  bench.sensors.acceleration_m_s2[0] = 5.0;  // it brakes
  bench.sensors.acceleration_m_s2[1] = 9.81 * std::sin(0.1);
  bench.sensors.acceleration_m_s2[2] = 9.81 * std::cos(0.1);
  bench.estimator.reset({.tilt = {0.1, 0.0}});
  bench.step(5.0);
  EXPECT_NEAR(bench.estimator.seen().tilt[0], 0.1, 1e-12);
  EXPECT_EQ(bench.estimator.seen().tilt[1], 0.0);
}

// ---- rates from angles

TEST(Rates, FollowTheirAnglesWithoutALastingError) {
  Bench bench;
  for (int k = 0; k < 200; ++k) {
    bench.sensors.disc_angle_rad = -5.0 * 0.001 * k;
    for (double& angle : bench.sensors.gimbal_angle_rad) angle = 0.2 * 0.001 * k;
    bench.step(0.001);
  }
  EXPECT_NEAR(bench.estimator.seen().disc_angle, -5.0 * 0.199, 1e-9);
  EXPECT_NEAR(bench.estimator.seen().disc_rate, -5.0, 1e-9);
  EXPECT_NEAR(bench.estimator.seen().gimbal_rate[2], 0.2, 1e-9);
}

// Critically damped: after a change of speed the estimate never passes it.
TEST(Rates, AnswerToAJumpWithoutOvershoot) {
  Bench bench;
  double half = 0.0;
  for (int k = 1; k < 200; ++k) {
    bench.sensors.disc_angle_rad = 1.0 * 0.001 * k;
    bench.step(0.001);
    EXPECT_LT(bench.estimator.seen().disc_rate, 1.0 + 1e-9);
    if (half == 0.0 && bench.estimator.seen().disc_rate > 0.5) half = 0.001 * k;
  }
  // 1.68 over the bandwidth, in continuous time.
  EXPECT_NEAR(half * bench.rig.estimator.disc, 1.68, 0.5);  // measured 1.6
}

TEST(Rates, GimbalsThatShareACoordinateAreAveraged) {
  Bench bench("double_brennan");
  bench.rest({});
  const double angles[4] = {0.10, -0.12, -0.3, 0.3};  // geared 1 : -1
  std::copy(std::begin(angles), std::end(angles), bench.sensors.gimbal_angle_rad);
  bench.step(0.2);
  const auto& seen = bench.estimator.seen();
  EXPECT_NEAR(seen.gimbal_angle[0], 0.11, 1e-9);
  EXPECT_NEAR(seen.gimbal_angle[1], -0.11, 1e-9);
  EXPECT_NEAR(seen.gimbal_angle[2], -0.3, 1e-9);

  bench.sensors.gimbal_angle_rad[0] = kNaN;
  bench.step(0.2);
  EXPECT_TRUE(bench.knows(state_t::VALID_GIMBALS));
  EXPECT_NEAR(bench.estimator.seen().gimbal_angle[0], 0.12, 1e-9);
}

// ---- what is known

TEST(Known, FromTheResetOn) {
  Bench bench;
  const model::Observation start{.tilt = {0.01, 0.02}, .disc_rate = -5.0, .gimbal_angle = {0.3}};
  bench.estimator.reset(start);
  EXPECT_EQ(bench.estimator.seen().disc_rate, -5.0);
  const std::int32_t all = 31;  // all groups but VALID_DRIVES, which the owner answers for
  EXPECT_EQ(bench.estimator.valid(), all);
  bench.rest({0.01, 0.02});
  bench.step(0.001);
  EXPECT_EQ(bench.estimator.valid(), all);
}

TEST(Known, DiscTiltWhereTheMountDecidesIt) {
  const auto seen = [](const std::string& mount) {
    Bench bench("prototype_b", {"umbrella.mount=" + mount});
    bench.rest({0.1, 0.2});
    bench.estimator.reset({.tilt = {0.1, 0.2}, .disc_tilt = {0.5, 0.5}});
    EXPECT_EQ(bench.estimator.seen().disc_tilt[0], mount == "rigid" ? 0.1 : 0.0);
    bench.step(0.1);
    EXPECT_NEAR(bench.estimator.seen().disc_tilt[1], mount == "rigid" ? 0.2 : 0.0, 1e-12);
    return bench.knows(state_t::VALID_DISC_TILT);
  };
  EXPECT_TRUE(seen("level"));
  EXPECT_TRUE(seen("rigid"));
  Bench free("prototype_b_sleeping");
  free.rest({0.1, 0.2});
  free.step(0.1);
  EXPECT_FALSE(free.knows(state_t::VALID_DISC_TILT));
  EXPECT_EQ(free.estimator.seen().disc_tilt[0], 0.0);
  free.estimator.reset({.disc_tilt = {0.1, 0.1}});
  EXPECT_FALSE(free.knows(state_t::VALID_DISC_TILT));
  EXPECT_EQ(free.estimator.seen().disc_tilt[0], 0.0);
}

// ---- doing without

TEST(Without, GyroTheAccelerometerGivesAttitudeAndRates) {
  Bench bench;
  bench.sensors.valid &= ~sensors_t::VALID_GYRO;
  for (int k = 0; k < 2000; ++k) {
    bench.rest({0.05 * 0.001 * k, 0.02});
    bench.step(0.001);
  }
  EXPECT_TRUE(bench.knows(state_t::VALID_TILT));
  EXPECT_LT(bench.error(), 1e-12);                                // measured 5e-17
  EXPECT_NEAR(bench.estimator.seen().tilt_rate[0], 0.05, 1e-12);  // measured 8e-16
}

TEST(Without, GyroForAWhileItsBiasIsKept) {
  Bench bench;
  bench.gyro_bias = {0.02, 0.0, 0.0};
  bench.rest({});
  bench.step(60.0);
  bench.sensors.valid &= ~sensors_t::VALID_GYRO;
  bench.rest({0.1, 0.0});
  bench.step(2.0);
  bench.sensors.valid |= sensors_t::VALID_GYRO;
  bench.step(0.001);
  EXPECT_LT(bench.error(), 1e-4);                               // no jump; measured 6e-8
  EXPECT_NEAR(bench.estimator.seen().tilt_rate[0], 0.0, 5e-4);  // bias off still; measured 5.5e-5
}

TEST(Without, AccelerometerTheGyroIsIntegratedLessItsBias) {
  Bench bench;
  bench.gyro_bias = {0.02, 0.0, 0.0};
  bench.rest({});
  bench.step(100.0);
  const double left = std::abs(bench.estimator.seen().tilt_rate[0]);
  bench.sensors.valid &= ~sensors_t::VALID_ACCELEROMETER;
  bench.step(10.0);
  EXPECT_TRUE(bench.knows(state_t::VALID_TILT));
  EXPECT_LT(bench.error(), 1e-5 + 10.0 * left);
  EXPECT_LT(bench.error(), 1e-3);  // measured 1.1e-5; with the bias it would be 0.2
}

TEST(Without, AnySensorItsAngleCoastsAndIsThenUnknown) {
  struct Case {
    std::int32_t sensors, group;
  };
  for (const auto& [lost, group] :
       {Case{kImu, state_t::VALID_TILT}, Case{sensors_t::VALID_DISC, state_t::VALID_DISC},
        Case{sensors_t::VALID_GIMBALS, state_t::VALID_GIMBALS}}) {
    Bench bench;
    double t = 0.0;
    const auto go = [&](double seconds) {
      const auto ticks = std::llround(1000.0 * seconds);
      for (std::int64_t k = 0; k < ticks; ++k) {
        t += 0.001;
        bench.move({0.3 * t, 0.0}, {0.3, 0.0}, {});
        bench.sensors.disc_angle_rad = 2.0 * t;
        for (double& angle : bench.sensors.gimbal_angle_rad) angle = 0.5 * t;
        bench.step(0.001);
      }
    };
    const auto worst = [&] {
      const auto& seen = bench.estimator.seen();
      return std::max({bench.error(), std::abs(seen.disc_angle - 2.0 * t),
                       std::abs(seen.gimbal_angle[1] - 0.5 * t)});
    };
    go(0.3);
    const std::int32_t all = bench.estimator.valid();
    bench.sensors.valid &= ~lost;
    go(OnboardEstimator::kCoast);
    EXPECT_EQ(bench.estimator.valid(), all) << lost;
    EXPECT_LT(worst(), 1e-9) << lost;  // measured 1.2e-11
    go(0.001);
    EXPECT_EQ(bench.estimator.valid(), all & ~group) << lost;
    EXPECT_TRUE(finite(bench.estimator.seen()));
    const auto& seen = bench.estimator.seen();
    EXPECT_EQ(group == state_t::VALID_TILT   ? seen.tilt[0]
              : group == state_t::VALID_DISC ? seen.disc_rate
                                             : seen.gimbal_rate[0],
              0.0);
    go(0.5);
    bench.sensors.valid |= lost;
    go(0.001);
    EXPECT_EQ(bench.estimator.valid(), all) << lost;
    EXPECT_LT(worst(), 1e-9) << lost;  // measured 2.4e-11
    go(0.3);
    EXPECT_NEAR(bench.estimator.seen().tilt_rate[0], 0.3, 1e-9) << lost;  // measured 4.5e-11
    EXPECT_NEAR(bench.estimator.seen().disc_rate, 2.0, 1e-9) << lost;
    EXPECT_NEAR(bench.estimator.seen().gimbal_rate[3], 0.5, 1e-9) << lost;
  }
}

// Without an upright to start from, a gyro alone tells no tilt.
TEST(Without, ImuAndThenWithTheGyroAloneTiltStaysUnknown) {
  Bench bench;
  bench.rest({0.1, 0.0});
  bench.step(10.0);
  bench.sensors.valid &= ~kImu;
  bench.step(0.1);
  bench.sensors.valid |= sensors_t::VALID_GYRO;
  bench.step(0.1);
  EXPECT_FALSE(bench.knows(state_t::VALID_TILT));
  EXPECT_EQ(bench.estimator.seen().tilt[0], 0.0);
  bench.sensors.valid |= sensors_t::VALID_ACCELEROMETER;
  bench.step(0.001);
  EXPECT_TRUE(bench.knows(state_t::VALID_TILT));
  EXPECT_LT(bench.error(), 1e-9);
}

TEST(Without, RotorSpeedsTheyAreUnknown) {
  Bench bench;
  bench.step(0.01);
  EXPECT_EQ(bench.estimator.seen().rotor_speed[3], 100.0);
  bench.sensors.rotor_speed_rad_s[2] = kInfinity;
  bench.step(0.001);
  EXPECT_FALSE(bench.knows(state_t::VALID_ROTORS));
  for (double speed : bench.estimator.seen().rotor_speed) EXPECT_EQ(speed, 0.0);
}

// Whatever the sensors say, and whichever of them are heard.
TEST(Without, SenseTheEstimateStaysFinite) {
  for (const char* name : {"prototype_b", "double_brennan", "brennan_monorail"}) {
    Bench bench(name);
    bench.rest({});
    std::uint64_t draw = 0;
    const auto random = [&] { return normal(7, 0, draw++); };
    const auto spoil = [&](double& value) {
      const double dice = random();
      if (dice > 2.0) value = kNaN;
      if (dice < -2.0) value = dice < -2.5 ? -kInfinity : 1e300;
      if (std::abs(dice) < 0.5) value = 1e9 * random();
      if (std::abs(dice) > 1.5 && std::abs(dice) < 2.0) value = random();
    };
    for (int k = 0; k < 50'000; ++k) {
      bench.sensors.valid = static_cast<std::int32_t>(std::abs(1e6 * random())) & 0x1ff;
      for (double& x : bench.sensors.gyro_rad_s) spoil(x);
      for (double& x : bench.sensors.acceleration_m_s2) spoil(x);
      for (double& x : bench.sensors.gimbal_angle_rad) spoil(x);
      for (double& x : bench.sensors.rotor_speed_rad_s) spoil(x);
      spoil(bench.sensors.disc_angle_rad);
      bench.step(bench.rig.loop.tick_s());
      ASSERT_TRUE(finite(bench.estimator.seen())) << name << " " << k;
    }
  }
}

TEST(OnboardEstimator, DoesNotAllocate) {
  Bench bench;
  bench.rest({0.1, 0.0});
  const AllocationCounter allocations;
  bench.step(0.1);
  bench.sensors.valid = 0;
  bench.step(0.1);
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace gyrotwin
