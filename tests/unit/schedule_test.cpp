// Disturbances and faults as a machine and its sensors meet them, tick by tick.
#include "services/integrator/schedule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "services/runtime/text.hpp"
#include "tests/support/schedule_bench.hpp"

namespace gyrotwin {
namespace {

using support::disturbance;
using support::fault;
using support::ScheduleBench;

constexpr std::int64_t kMs = 1'000'000;  // a tick of the bench's rigs [ns]

TEST(Schedule, NumbersFromOneAndSaysWhenItActs) {
  ScheduleBench bench;
  request_t load = disturbance(request_t::LOAD);
  load.force_n[1] = 2.0;
  load.duration_ns = 3 * kMs;
  load.start_tick = 5;
  EXPECT_EQ(bench.add(load, 2), 1);
  EXPECT_EQ(bench.reply.applied_tick, 5);
  EXPECT_EQ(text_view(bench.reply.text), "number 1, ticks 5 to 7");
  load.start_tick = 0;
  load.duration_ns = 0;
  EXPECT_EQ(bench.add(load, 2), 2);
  EXPECT_EQ(bench.reply.applied_tick, 2);
  EXPECT_EQ(text_view(bench.reply.text), "number 2, from tick 2 until it is cancelled");
  EXPECT_EQ(bench.schedule.disturbances(), 2);

  bench.schedule.reset();
  EXPECT_EQ(bench.schedule.disturbances(), 0);
  EXPECT_EQ(bench.add(load), 1) << "a new run counts anew";
  bench.schedule.clear();
  EXPECT_EQ(bench.add(load), 2) << "within a run it does not";
}

TEST(Schedule, ActsInItsTicksAndIsForgotten) {
  ScheduleBench bench;
  request_t load = disturbance(request_t::LOAD);
  load.moment_nm[0] = 2.0;
  load.duration_ns = 3'400'000;  // rounds to 3 ticks
  load.start_tick = 5;
  bench.add(load);
  for (std::int64_t tick = 0; tick < 12; ++tick) {
    EXPECT_EQ(bench.schedule.disturbances(), tick < 8 ? 1 : 0) << tick;
    EXPECT_EQ(bench.apply(tick).moment.x(), tick >= 5 && tick < 8 ? 2.0 : 0.0) << tick;
  }
}

TEST(Schedule, ShorterThanATickIsATick) {
  ScheduleBench bench;
  request_t load = disturbance(request_t::LOAD);
  load.moment_nm[0] = 2.0;
  load.duration_ns = 1;
  bench.add(load);
  EXPECT_EQ(bench.apply(0).moment.x(), 2.0);
  EXPECT_EQ(bench.apply(1).moment.x(), 0.0);
}

TEST(Schedule, CancelEndsOneAndOnlyOnce) {
  ScheduleBench bench;
  request_t load = disturbance(request_t::LOAD);
  for (const double strength : {1.0, 2.0, 4.0}) {
    load.moment_nm[0] = strength;
    bench.add(load);
  }
  EXPECT_EQ(bench.apply(0).moment.x(), 7.0);
  EXPECT_TRUE(bench.schedule.cancel(2, bench.reply));
  EXPECT_EQ(bench.reply.result, reply_t::APPLIED);
  EXPECT_EQ(bench.apply(1).moment.x(), 5.0);
  EXPECT_FALSE(bench.schedule.cancel(2, bench.reply));
  EXPECT_EQ(bench.reply.result, reply_t::REFUSED);
  EXPECT_FALSE(bench.schedule.cancel(0, bench.reply));
  bench.schedule.clear();
  EXPECT_EQ(bench.apply(2).moment.x(), 0.0);
}

TEST(Schedule, RampsSwingsAndSweepsAtTheMiddleOfEachTick) {
  ScheduleBench bench;
  request_t ramp = disturbance(request_t::LOAD);
  ramp.force_n[0] = 3.0;
  ramp.rise_ns = 10 * kMs;
  bench.add(ramp);
  request_t sine = disturbance(request_t::SINE);
  sine.force_n[1] = 5.0;
  sine.frequency_hz[0] = 20.0;
  bench.add(sine);
  request_t chirp = disturbance(request_t::CHIRP);
  chirp.moment_nm[0] = 7.0;
  chirp.frequency_hz[0] = 10.0;
  chirp.frequency_hz[1] = 200.0;
  chirp.duration_ns = 100 * kMs;
  bench.add(chirp);
  for (std::int64_t tick = 0; tick < 120; ++tick) {
    const model::Input input = bench.apply(tick);
    const double t = 1e-3 * (static_cast<double>(tick) + 0.5);
    EXPECT_NEAR(input.force.x(), 3.0 * std::min(1.0, t / 0.010), 1e-14);  // measured 4.4e-16
    EXPECT_NEAR(input.force.y(), 5.0 * std::sin(2 * std::numbers::pi * 20.0 * t), 1e-14);
    // The frequency's integral, by its mean over [0, t].
    const double mean = 10.0 + 0.5 * (t / 0.100) * 190.0;
    const double expected = tick < 100 ? 7.0 * std::sin(2 * std::numbers::pi * mean * t) : 0.0;
    EXPECT_NEAR(input.moment.x(), expected, 1e-12) << tick;  // measured 9e-14
  }
}

TEST(Schedule, AGustHasItsStrengthInEachComponentOfItsOwn) {
  ScheduleBench bench;
  request_t gust = disturbance(request_t::GUST);
  gust.force_n[0] = 2.0;
  gust.moment_nm[0] = 0.5;
  gust.moment_nm[1] = 3.0;
  gust.correlation_s = 0.005;
  gust.seed = 11;
  gust.duration_ns = 2'000'000 * kMs;
  bench.add(gust);
  constexpr int kTicks = 1'000'000;
  Eigen::Vector3d square = Eigen::Vector3d::Zero(), product = Eigen::Vector3d::Zero();
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const model::Input input = bench.apply(tick);
    const Eigen::Vector3d x(input.force.x() / 2.0, input.moment.x() / 0.5, input.moment.y() / 3.0);
    square += x.cwiseAbs2() / kTicks;
    product += x.cwiseProduct(Eigen::Vector3d(x.y(), x.z(), x.x())) / kTicks;
    ASSERT_EQ(input.force.y(), 0.0);
    ASSERT_EQ(input.force.z(), 0.0);
    ASSERT_EQ(input.moment.z(), 0.0);
  }
  // A million ticks are 100,000 independent draws of twice the correlation time: the standard error
  // of a mean square is 0.0045, that of a product 0.0032.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(square[i], 1.0, 0.0225) << i;  // measured 0.0059
    EXPECT_NEAR(product[i], 0.0, 0.016) << i;  // measured 0.0059
  }
}

TEST(Schedule, TheSameSeedGivesTheSameGustWhateverElseActs) {
  const auto gust_of = [](std::int64_t seed, bool beside) {
    ScheduleBench bench;
    request_t gust = disturbance(request_t::GUST);
    gust.moment_nm[0] = 1.0;
    gust.correlation_s = 0.1;
    if (beside) {
      gust.seed = 5;
      gust.force_n[1] = 1.0;
      gust.moment_nm[0] = 0.0;
      bench.add(gust);
      gust.force_n[1] = 0.0;
      gust.moment_nm[0] = 1.0;
    }
    gust.seed = seed;
    gust.start_tick = beside ? 40 : 10;
    bench.add(gust);
    std::vector<double> series;
    for (std::int64_t tick = 0; tick < 100; ++tick) {
      const double x = bench.apply(tick).moment.x();
      if (tick >= gust.start_tick) series.push_back(x);
    }
    series.resize(50);
    return series;
  };
  EXPECT_EQ(gust_of(3, false), gust_of(3, true));
  EXPECT_NE(gust_of(3, false), gust_of(4, false));
  EXPECT_NE(gust_of(3, false)[0], 0.0) << "there from its first tick";
}

TEST(Schedule, WindPressesWithTheSquareOfItsSpeedAtItsHeight) {
  ScheduleBench bench;
  request_t wind = disturbance(request_t::WIND);
  wind.speed_m_s = 4.0;
  wind.direction_rad = 2.0;
  wind.rise_ns = 3 * kMs;
  bench.add(wind);
  for (std::int64_t tick = 0; tick < 5; ++tick) {
    const model::Input input = bench.apply(tick);
    const double speed = 4.0 * std::min(1.0, (static_cast<double>(tick) + 0.5) / 3.0);
    const double force = 0.5 * 1.225 * 1.2 * 0.3 * speed * speed;  // the bench's [wind]
    const Eigen::Vector3d expected(force * std::cos(2.0), force * std::sin(2.0), 0.0);
    EXPECT_LT((input.force - expected).norm(), 1e-14) << tick;  // measured 4.4e-16
    // Where it acts, seen from the ground pivot.
    const Eigen::Vector3d at_pivot = input.moment + bench.machine.push_point.cross(input.force);
    EXPECT_LT((at_pivot - Eigen::Vector3d(0, 0, 0.8).cross(expected)).norm(),
              1e-14);  // measured 2e-16
  }
}

TEST(Schedule, WindIsTurbulentAlongAndAcross) {
  ScheduleBench bench;
  request_t wind = disturbance(request_t::WIND);
  wind.speed_m_s = 10.0;
  wind.turbulence_m_s = 0.5;
  wind.length_m = 0.1;  // a hundredth of a second
  wind.direction_rad = 0.5 * std::numbers::pi;
  wind.seed = 2;
  bench.add(wind);
  constexpr int kTicks = 1'000'000;
  const double k = 0.5 * 1.225 * 1.2 * 0.3;
  double along = 0.0, across = 0.0, both = 0.0;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const Eigen::Vector3d force = bench.apply(tick).force;
    // V = |F| / k along F: back to the air's speed.
    const Eigen::Vector3d air = force / std::sqrt(k * force.norm());
    along += (air.y() - 10.0) * (air.y() - 10.0) / kTicks;
    across += air.x() * air.x() / kTicks;
    both += (air.y() - 10.0) * air.x() / kTicks;
  }
  // A million ticks are 50,000 independent draws of twice the correlation time: 0.0063 of itself.
  EXPECT_NEAR(along, 0.25, 0.25 * 0.032);   // measured 0.25 * 0.0091
  EXPECT_NEAR(across, 0.25, 0.25 * 0.032);  // measured 0.25 * 0.0005
  EXPECT_NEAR(both, 0.0, 0.25 * 0.023);     // measured 0.25 * 0.0036
}

TEST(Schedule, TurnsAndDecelerationsMoveTheGround) {
  ScheduleBench bench;
  request_t turn = disturbance(request_t::TURN);
  turn.speed_m_s = 10.0;
  turn.yaw_rate_rad_s = 0.5;
  turn.rise_ns = 2 * kMs;
  bench.add(turn);
  request_t braking = disturbance(request_t::DECELERATION);
  braking.deceleration_m_s2 = 3.0;
  braking.start_tick = 1;
  bench.add(braking);
  const double yaw_rate[] = {0.125, 0.375, 0.5, 0.5};
  for (std::int64_t tick = 0; tick < 4; ++tick) {
    const model::Input input = bench.apply(tick);
    EXPECT_EQ(input.yaw_rate, yaw_rate[tick]);
    const Eigen::Vector3d expected(tick >= 1 ? -3.0 : 0.0, 10.0 * yaw_rate[tick], 0.0);
    EXPECT_EQ(input.ground_acceleration, expected) << tick;
  }
}

TEST(Schedule, MassesAreOnTheStructureFourAtATime) {
  ScheduleBench bench;
  request_t mass = disturbance(request_t::ADDED_MASS);
  mass.position_m[2] = 0.5;
  mass.duration_ns = 2 * kMs;
  for (int i = 0; i < model::kMaxAddedMasses; ++i) {
    mass.mass_kg = 1.0 + i;
    EXPECT_NE(bench.add(mass), 0);
  }
  EXPECT_EQ(bench.add(mass), 0) << "a fifth";
  mass.start_tick = 2;
  EXPECT_NE(bench.add(mass), 0) << "when the others are gone";
  const auto masses = [&](std::int64_t tick) {
    std::vector<double> result;
    for (const model::PointMass& added : bench.apply(tick).added) result.push_back(added.mass);
    return result;
  };
  EXPECT_EQ(masses(0), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_TRUE(bench.schedule.cancel(2, bench.reply));
  EXPECT_EQ(masses(1), (std::vector<double>{1, 3, 4}));
  EXPECT_EQ(masses(2), (std::vector<double>{4}));
}

TEST(Schedule, WeakensDrivesAndTakesPowerFromRotors) {
  ScheduleBench bench;
  request_t weak = fault(request_t::DRIVE_WEAK);
  weak.level = 0.5;
  bench.add(weak);  // drive 0
  weak.target = -1;
  weak.duration_ns = kMs;
  bench.add(weak);
  request_t loss = fault(request_t::ROTOR_LOSS);
  loss.target = 1;
  loss.level = 0.2;
  bench.add(loss);
  EXPECT_EQ(bench.schedule.faults(), 3);
  EXPECT_EQ(bench.schedule.disturbances(), 0);

  model::Input input = bench.apply(0);
  EXPECT_EQ(input.drive_strength[0], 0.25);
  EXPECT_EQ(input.rotor_powered, (std::array<bool, 4>{true, false, true, true}));
  EXPECT_EQ(input.rotor_brake, (std::array<double, 4>{0.0, 0.2, 0.0, 0.0}));
  input = bench.apply(1);
  EXPECT_EQ(input.drive_strength[0], 0.5);
  EXPECT_EQ(bench.schedule.faults(), 2);
}

TEST(Schedule, CutsTheCommandLinkForItsTicks) {
  ScheduleBench bench;
  request_t cut = fault(request_t::COMMAND_LOST);
  cut.start_tick = 2;
  cut.duration_ns = 3 * kMs;
  bench.add(cut);
  for (std::int64_t tick = 0; tick < 8; ++tick) {
    EXPECT_EQ(bench.schedule.command_lost(tick), tick >= 2 && tick < 5) << tick;
    bench.apply(tick);
  }
  EXPECT_EQ(bench.schedule.faults(), 0);
}

TEST(Schedule, NothingAllocatesOnceItIsThere) {
  ScheduleBench bench;
  const AllocationCounter allocations;
  request_t gust = disturbance(request_t::GUST);
  gust.force_n[0] = 1.0;
  gust.correlation_s = 1.0;
  bench.add(gust);
  request_t late = fault(request_t::SENSOR_DELAYED);
  late.target = sensors_t::VALID_GYRO;
  late.delay_ns = 500 * kMs;
  bench.add(late);
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    bench.apply(tick);
    bench.read(tick);
  }
  EXPECT_EQ(allocations.count(), 0);
}

}  // namespace
}  // namespace gyrotwin
