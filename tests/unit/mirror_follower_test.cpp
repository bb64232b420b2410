// The twin's filter by itself: what it is told, what it makes of it, and what it survives.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "services/onboard/noise.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/twin_bench.hpp"

namespace gyrotwin {
namespace {

using support::TwinBench;

TEST(Follower, NeedsSensors) {
  Rig rig = load_rig("prototype_b");
  rig.sensors.reset();
  const model::Machine machine = rig.build_machine();
  EXPECT_THROW(Follower(rig, machine), Error);
  EXPECT_THROW(Health(rig, machine), Error);
}

TEST(Follower, StartsWhereTheSensorsSay) {
  TwinBench bench("prototype_b");
  const model::State& state = bench.follower.estimate().state;
  EXPECT_NEAR(state.q[0], 0.0175, 0.01);   // 1 deg, by the accelerometer; measured 0.0158
  EXPECT_NEAR(state.q[3], 0.0107, 0.002);  // by four encoders; measured 0.0116
  EXPECT_NEAR(state.v[2], -5.0, 1e-9);     // no sensor tells: the rig's [initial]
  EXPECT_FALSE(bench.follower.settled());
}

// Every shipped rig is followed from its start through a push, to a few sigmas.
TEST(Follower, FollowsEveryShippedRig) {
  for (const std::string& name : shipped_rigs()) {
    TwinBench bench(name);
    ASSERT_TRUE(bench.run(1.2)) << name;
    EXPECT_TRUE(bench.follower.settled()) << name;
    if (bench.machine.layout.tilts() > 0) bench.push(0.5);
    ASSERT_TRUE(bench.run(0.3)) << name;
    EXPECT_EQ(bench.follower.losses(), 0) << name;
    // Chi-square of 12 numbers passes 45 once in 10^5.
    EXPECT_LT(bench.nees(), 45.0) << name;
    EXPECT_NE(bench.follower.valid(), 0) << name;
  }
}

TEST(Follower, EstimatesBiasesAndTheMoment) {
  TwinBench bench("double_brennan");
  bench.disturb = [](TwinBench&, model::Input& input) { input.moment = {0.8, -0.5, 0.0}; };
  ASSERT_TRUE(bench.run(3.0));
  const Estimate& e = bench.follower.estimate();
  EXPECT_NEAR(e.external_moment[0], 0.8, 4.0 * e.external_moment_sigma[0]);
  EXPECT_NEAR(e.external_moment[1], -0.5, 4.0 * e.external_moment_sigma[1]);
  EXPECT_LT(e.external_moment_sigma[0], 0.15);  // measured 0.07
  // The simulated bias of sensor i is normal(seed, sensors + i, 0) of the rig file's.
  for (int i = 0; i < 3; ++i) {
    const double bias =
        bench.rig.sensors->gyro.bias * normal(static_cast<std::uint64_t>(bench.rig.sensors->seed),
                                              static_cast<std::uint64_t>(21 + i), 0);
    EXPECT_NEAR(e.gyro_bias[i], bias, 4e-4) << i;  // measured 1e-4
  }
}

TEST(Follower, CountsRotorsAsTheyAre) {
  TwinBench bench("prototype_b", {"rotor_drive.start_share=0.95"});
  ASSERT_TRUE(bench.run(0.5));
  for (int j = 0; j < 4; ++j) {
    EXPECT_NEAR(bench.follower.estimate().state.rotor_speed[j], bench.plant.state().rotor_speed[j],
                1.0);  // measured 0.3
  }
}

TEST(Follower, BridgesWhatIsMissing) {
  TwinBench bench("double_brennan");
  ASSERT_TRUE(bench.run(1.5));
  // Every second message is lost, and at times twenty on end.
  Follower thinned(bench.rig, bench.machine);
  thinned.start(bench.sensors);
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(bench.step());
    if (k % 2 == 0 && k % 100 > 20) thinned.step(bench.sensors, bench.commanded);
  }
  const auto difference = thinned.estimate().state.q - bench.plant.state().q;
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.01);  // measured 2.8e-3, the accelerometer's bias
  EXPECT_EQ(thinned.losses(), 0);
}

TEST(Follower, StartsAnewAfterALongSilence) {
  for (const int missing : {50, 51}) {
    TwinBench bench("double_brennan");
    ASSERT_TRUE(bench.run(1.5));
    sensors_t late = bench.sensors;
    late.header.tick += 1 + missing;
    bench.follower.step(late, bench.commanded);
    EXPECT_EQ(bench.follower.settled(), missing == 50);
    EXPECT_EQ(bench.follower.losses(), 0);
    Follower anew(bench.rig, bench.machine);
    anew.start(late);
    EXPECT_EQ(bench.follower.estimate().state.q == anew.estimate().state.q, missing == 51);
    EXPECT_EQ(bench.follower.deviation() == anew.deviation(), missing == 51);
  }
}

TEST(Follower, SurvivesWhatIsNoNumber) {
  TwinBench bench("prototype_b");
  ASSERT_TRUE(bench.run(0.5));
  for (int k = 0; k < 200; ++k) {
    sensors_t wild = bench.sensors;
    wild.header.tick = bench.tick + 1 + k;
    const double bad = k % 3 == 0   ? std::numeric_limits<double>::quiet_NaN()
                       : k % 3 == 1 ? std::numeric_limits<double>::infinity()
                                    : 1e300;
    for (double& x : wild.gyro_rad_s) x = bad;
    for (double& x : wild.gimbal_angle_rad) x = -bad;
    for (double& x : wild.rotor_speed_rad_s) x = bad;
    wild.acceleration_m_s2[k % 3] = bad;
    wild.disc_angle_rad = bad;
    bench.follower.step(wild, bench.commanded);
    ASSERT_TRUE(bench.follower.estimate().state.finite()) << k;
    ASSERT_TRUE(bench.follower.deviation().allFinite()) << k;
    EXPECT_TRUE(bench.follower.innovations()[0].insane);
  }
}

TEST(Follower, GoesOnWithoutAnySensor) {
  TwinBench bench("prototype_b");
  ASSERT_TRUE(bench.run(0.5));
  const double before = bench.follower.deviation().row(0).norm();
  sensors_t nothing{};
  for (int k = 1; k <= 200; ++k) {
    nothing.header.tick = bench.tick + k;
    bench.follower.step(nothing, bench.commanded);
  }
  EXPECT_TRUE(bench.follower.estimate().state.finite());
  EXPECT_GT(bench.follower.deviation().row(0).norm(), before);
}

TEST(Follower, LooksAheadOverTheSensorsDelay) {
  TwinBench prompt("double_brennan"), late("double_brennan", {}, {"sensors.delay_ticks=3"});
  for (TwinBench* bench : {&prompt, &late}) {
    ASSERT_TRUE(bench->run(1.2));
    bench->push();
    ASSERT_TRUE(bench->run(0.3));
  }
  // Three ticks of 2 ms in which it turns at 0.3 rad/s would be 2 mrad.
  EXPECT_LT(prompt.error().head(4).cwiseAbs().maxCoeff(), 5e-3);  // measured 2.7e-3
  EXPECT_LT(late.error().head(4).cwiseAbs().maxCoeff(), 5e-3);    // measured 2.9e-3
}

TEST(Follower, DrawsWhatItsUncertaintyAllows) {
  TwinBench bench("double_brennan");
  ASSERT_TRUE(bench.run(1.5));
  const int n = bench.follower.dimension();
  constexpr int kDraws = 4000;
  std::vector<double> numbers(static_cast<std::size_t>(kDraws) * n);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = normal(5, 6, i);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < kDraws; ++k) {
    const model::State draw = bench.follower.draw(k, numbers);
    Eigen::VectorXd d(n);
    d << (draw.q - bench.follower.estimate().state.q).head(n / 2),
        (draw.v - bench.follower.estimate().state.v).head(n / 2);
    sum += d * d.transpose() / kDraws;
  }
  const Eigen::MatrixXd S = bench.follower.deviation();
  const Eigen::MatrixXd P = S * S.transpose();
  for (int i = 0; i < n; ++i) EXPECT_NEAR(sum(i, i) / P(i, i), 1.0, 0.12);  // 5 sigma
}

TEST(Follower, SameInputSameBytes) {
  TwinBench one("prototype_b"), two("prototype_b");
  for (TwinBench* bench : {&one, &two}) {
    ASSERT_TRUE(bench->run(0.2));
    bench->push();
    ASSERT_TRUE(bench->run(0.2));
  }
  EXPECT_EQ(0, std::memcmp(&one.said, &two.said, sizeof one.said));
  EXPECT_EQ(one.follower.estimate().state.q, two.follower.estimate().state.q);
  EXPECT_EQ(one.follower.deviation(), two.follower.deviation());
}

TEST(Follower, DoesNotAllocate) {
  for (const char* name : {"prototype_b", "prototype_b_sleeping", "double_brennan", "gyrocar"}) {
    TwinBench bench(name);
    ASSERT_TRUE(bench.run(1.1));
    std::vector<double> numbers(32, 0.1);
    const AllocationCounter allocations;
    bench.push();
    ASSERT_TRUE(bench.run(0.1));  // opens and closes hypotheses
    bench.fault(request_t::SENSOR_NOISY, sensors_t::VALID_GIMBALS, 0.05);
    ASSERT_TRUE(bench.run(0.1));  // refuses a sensor
    bench.follower.draw(0, numbers);
    bench.follower.start(bench.sensors);
    EXPECT_EQ(allocations.count(), 0) << name;
  }
}

}  // namespace
}  // namespace gyrotwin
