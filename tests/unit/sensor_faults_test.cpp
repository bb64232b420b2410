// Faults of sensors: what they do to the readings, and when.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/schedule_bench.hpp"

namespace gyrotwin {
namespace {

using support::fault;
using support::ScheduleBench;

constexpr std::int64_t kMs = 1'000'000;  // a tick of the bench's rig [ns]

TEST(SensorFaults, BeginWithTheNextReading) {
  ScheduleBench bench;
  bench.read(0);
  request_t dropped = fault(request_t::SENSOR_DROPPED, sensors_t::VALID_GYRO);
  dropped.duration_ns = 2 * kMs;
  bench.add(dropped, 0);
  EXPECT_EQ(bench.reply.applied_tick, 1);
  for (std::int64_t tick = 1; tick < 5; ++tick) {
    bench.apply(tick - 1);
    EXPECT_EQ(bench.schedule.faults(), tick < 3 ? 1 : 0) << tick;
    const sensors_t heard = bench.read(tick);
    const bool gone = tick < 3;
    EXPECT_EQ(bool(heard.valid & sensors_t::VALID_GYRO), !gone) << tick;
    EXPECT_TRUE(heard.valid & sensors_t::VALID_GIMBALS);
    EXPECT_EQ(heard.gyro_rad_s[2], gone ? 0.0 : 1000.0 * tick + 21.0);
    EXPECT_EQ(heard.gimbal_angle_rad[1], 1000.0 * tick + 12.0);
  }
}

TEST(SensorFaults, AStuckOneKeepsItsReadingOfTheOnset) {
  ScheduleBench bench;
  request_t stuck = fault(request_t::SENSOR_STUCK, sensors_t::VALID_ROTORS);
  stuck.start_tick = 3;
  stuck.duration_ns = 4 * kMs;
  bench.add(stuck);
  request_t stop = fault(request_t::SENSOR_STUCK, sensors_t::VALID_ESTOP);
  stop.start_tick = 5;
  bench.add(stop);
  for (std::int64_t tick = 0; tick < 10; ++tick) {
    const sensors_t heard = bench.read(tick);
    const double kept = tick >= 3 && tick < 7 ? 3000.0 : 1000.0 * tick;
    for (int j = 0; j < 4; ++j) EXPECT_EQ(heard.rotor_speed_rad_s[j], kept + 10.0 * j + 3.0);
    EXPECT_EQ(heard.gyro_rad_s[0], 1000.0 * tick + 1.0);
    EXPECT_EQ(heard.estop, std::min<std::int64_t>(tick, 5));
  }
}

TEST(SensorFaults, BiasesAddUpOnEveryChannelThatTheMachineHas) {
  ScheduleBench bench("prototype_b");
  request_t biased = fault(request_t::SENSOR_BIASED, sensors_t::VALID_GYRO);
  biased.level = 0.5;
  bench.add(biased);
  biased.level = -2.0;
  bench.add(biased);
  const sensors_t heard = bench.read(1);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(heard.gyro_rad_s[i], 1000.0 + 10.0 * i + 1.0 - 1.5);

  ScheduleBench two("double_brennan");
  const int gimbals = static_cast<int>(two.machine.layout.gimbals.size());
  ASSERT_GT(gimbals, 0);
  biased.target = sensors_t::VALID_GIMBALS;
  two.add(biased);
  const sensors_t seen = two.read(1);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(seen.gimbal_angle_rad[j], 1000.0 + 10.0 * j + 2.0 - (j < gimbals ? 2.0 : 0.0));
  }
}

TEST(SensorFaults, NoiseHasItsDeviationAndNoMean) {
  ScheduleBench bench;
  request_t noisy = fault(request_t::SENSOR_NOISY, sensors_t::VALID_GYRO);
  noisy.level = 0.3;
  noisy.seed = 4;
  bench.add(noisy);
  constexpr int kTicks = 200'000;
  double mean = 0.0, square = 0.0, product = 0.0;
  for (std::int64_t tick = 1; tick <= kTicks; ++tick) {
    const sensors_t heard = bench.read(tick);
    const auto noise = [&](int i) {
      return (heard.gyro_rad_s[i] - 1000.0 * static_cast<double>(tick) - 10.0 * i - 1.0) / 0.3;
    };
    mean += noise(0) / kTicks;
    square += noise(1) * noise(1) / kTicks;
    product += noise(1) * noise(2) / kTicks;
  }
  // Five standard errors of 200,000 draws.
  EXPECT_NEAR(mean, 0.0, 0.0112);     // measured 0.0014
  EXPECT_NEAR(square, 1.0, 0.0158);   // measured 0.0046
  EXPECT_NEAR(product, 0.0, 0.0112);  // measured 0.0007
}

TEST(SensorFaults, ADelayShowsThePastUpToASecond) {
  for (const std::int64_t delay_ms : {1, 7, 1000}) {
    ScheduleBench bench;
    request_t late = fault(request_t::SENSOR_DELAYED, sensors_t::VALID_GIMBALS);
    late.start_tick = 5;
    late.delay_ns = delay_ms * kMs;
    bench.add(late);
    for (std::int64_t tick = 0; tick < 2500; ++tick) {
      const sensors_t heard = bench.read(tick);
      const std::int64_t shown = tick < 5 ? tick : std::max<std::int64_t>(0, tick - delay_ms);
      ASSERT_EQ(heard.gimbal_angle_rad[0], 1000.0 * static_cast<double>(shown) + 2.0) << tick;
      ASSERT_EQ(heard.gyro_rad_s[0], 1000.0 * static_cast<double>(tick) + 1.0);
    }
  }
}

TEST(SensorFaults, ADelayComesBeforeTheOtherFaults) {
  ScheduleBench bench;
  request_t biased = fault(request_t::SENSOR_BIASED, sensors_t::VALID_GYRO);
  biased.level = 0.5;
  bench.add(biased);
  request_t late = fault(request_t::SENSOR_DELAYED, sensors_t::VALID_GYRO);
  late.delay_ns = 2 * kMs;
  bench.add(late);
  for (std::int64_t tick = 0; tick < 9; ++tick) {
    const sensors_t heard = bench.read(tick);
    if (tick >= 3) {
      EXPECT_EQ(heard.gyro_rad_s[0], 1000.0 * (tick - 2) + 1.5);
    }
  }
}

TEST(SensorFaults, NothingIsAddedToWhatIsNotHeard) {
  ScheduleBench bench;
  bench.add(fault(request_t::SENSOR_DROPPED, sensors_t::VALID_GYRO));
  request_t biased = fault(request_t::SENSOR_BIASED, sensors_t::VALID_GYRO);
  biased.level = 0.5;
  bench.add(biased);
  const sensors_t heard = bench.read(1);
  EXPECT_FALSE(heard.valid & sensors_t::VALID_GYRO);
  EXPECT_EQ(heard.gyro_rad_s[0], 0.0);
}

}  // namespace
}  // namespace gyrotwin
