// Every fault is named, in plain words, within the time that services/mirror/README.md states; and
// nothing is named that is not there.
#include <gtest/gtest.h>

#include <optional>

#include "tests/support/twin_bench.hpp"

namespace gyrotwin {
namespace {

using support::TwinBench;

/// Something wrong, and what is to be said of it.
struct Fault {
  const char* name;
  const char* rig;
  TwinBench::Overrides of_rig;       ///< wrong from the start
  std::optional<request_t> request;  ///< or from 1.5 s on
  double push;  ///< of the reference impulse, 0.2 s after, where rest shows nothing
  std::int32_t blame;
  std::int32_t index;
  std::int32_t sensor_verdict;  ///< of the blamed sensor
  double within_s;              ///< of the fault, or of the push
  const char* word;             ///< in the text
};

request_t fault(std::int32_t kind, std::int32_t target, double level = 0.0, double delay_s = 0.0) {
  request_t request{};
  request.kind = kind;
  request.target = target;
  request.level = level;
  request.delay_ns = std::llround(1e9 * delay_s);
  return request;
}

constexpr std::int32_t kGyro = health_t::SENSOR + 0, kAccelerometer = health_t::SENSOR + 1,
                       kDisc = health_t::SENSOR + 2, kGimbals = health_t::SENSOR + 3,
                       kRotors = health_t::SENSOR + 4;

std::vector<Fault> faults() {
  using R = request_t;
  using S = sensors_t;
  using H = health_t;
  const std::int32_t none = H::NONE;
  return {
      // measured: times beside the bounds, twice as long
      {"inertia",
       "prototype_b",
       {"structure.inertia_x_kgm2=0.1441", "structure.inertia_y_kgm2=0.1441"},
       {},
       1.0,
       H::INERTIA,
       0,
       none,
       0.2,
       "inertia is 10 % larger"},  // 0.06
      {"inertia_sleeping",
       "prototype_b_sleeping",
       {"structure.inertia_x_kgm2=0.1441", "structure.inertia_y_kgm2=0.1441"},
       {},
       8.0,
       H::INERTIA,
       0,
       none,
       0.15,
       "larger"},  // 0.07
      {"inertia_double",
       "double_brennan",
       {"structure.inertia_tilt_kgm2=0.38544"},
       {},
       1.0,
       H::INERTIA,
       0,
       none,
       0.2,
       "larger"},  // 0.06
      {"friction",
       "prototype_b",
       {"disc.viscous_friction_nms_per_rad=0.02", "disc.coulomb_friction_nm=0.2"},
       {},
       0.0,
       H::DISC_FRICTION,
       0,
       none,
       0.2,
       "more friction"},  // 0.05
      {"gyro_biased",
       "prototype_b",
       {},
       fault(R::SENSOR_BIASED, S::VALID_GYRO, 0.05),
       0.0,
       kGyro,
       0,
       H::DISAGREES,
       0.2,
       "gyro: off by 0.05"},  // 0.104
      {"gyro_biased_double",
       "double_brennan",
       {},
       fault(R::SENSOR_BIASED, S::VALID_GYRO, 0.05),
       0.0,
       kGyro,
       0,
       H::DISAGREES,
       0.2,
       "gyro: off by 0.05"},  // 0.104
      {"accelerometer_biased",
       "prototype_b",
       {},
       fault(R::SENSOR_BIASED, S::VALID_ACCELEROMETER, 0.5),
       0.0,
       kAccelerometer,
       0,
       H::DISAGREES,
       0.2,
       "accelerometer: off by"},  // 0.104
      {"disc_stuck",
       "prototype_b",
       {},
       fault(R::SENSOR_STUCK, S::VALID_DISC),
       0.0,
       kDisc,
       0,
       H::STUCK,
       0.05,
       "stuck"},  // 0.022
      {"gimbals_stuck",
       "prototype_b",
       {},
       fault(R::SENSOR_STUCK, S::VALID_GIMBALS),
       0.0,
       kGimbals,
       0,
       H::STUCK,
       0.08,
       "stuck"},  // 0.033
      {"gimbals_stuck_double",
       "double_brennan",
       {},
       fault(R::SENSOR_STUCK, S::VALID_GIMBALS),
       0.0,
       kGimbals,
       0,
       H::STUCK,
       0.15,
       "stuck"},  // 0.066
      {"gyro_stuck",
       "prototype_b",
       {},
       fault(R::SENSOR_STUCK, S::VALID_GYRO),
       0.0,
       kGyro,
       0,
       H::STUCK,
       0.08,
       "stuck"},  // 0.03
      {"rotor",
       "prototype_b",
       {},
       fault(R::ROTOR_LOSS, 1),
       0.0,
       H::ROTOR,
       1,
       none,
       1.0,
       "rotor 1"},  // 0.50
      {"drive",
       "prototype_b",
       {},
       fault(R::DRIVE_WEAK, 0, 0.5),
       0.0,
       H::DRIVE,
       0,
       none,
       0.2,
       "drive 0 gives"},  // 0.10
      {"drive_brennan",
       "brennan_monorail",
       {},
       fault(R::DRIVE_WEAK, 0, 0.5),
       1.0,
       H::DRIVE,
       0,
       none,
       0.5,
       "drive 0 gives"},  // 0.22
      {"gimbals_late",
       "prototype_b",
       {},
       fault(R::SENSOR_DELAYED, S::VALID_GIMBALS, 0.0, 0.03),
       1.0,
       kGimbals,
       0,
       H::LATE,
       0.1,
       "late by"},  // 0.01
      {"accelerometer_late",
       "prototype_b",
       {},
       fault(R::SENSOR_DELAYED, S::VALID_ACCELEROMETER, 0.0, 0.03),
       1.0,
       kAccelerometer,
       0,
       H::LATE,
       0.1,
       "late by"},  // 0.01
      {"gyro_late",
       "gyrocar",
       {},
       fault(R::SENSOR_DELAYED, S::VALID_GYRO, 0.0, 0.03),
       1.0,
       kGyro,
       0,
       H::LATE,
       0.1,
       "late by"},  // 0.042
      {"gyro_silent",
       "prototype_b",
       {},
       fault(R::SENSOR_DROPPED, S::VALID_GYRO),
       0.0,
       kGyro,
       0,
       H::SILENT,
       0.05,
       "silent"},  // 0.02
      {"disc_silent",
       "prototype_b",
       {},
       fault(R::SENSOR_DROPPED, S::VALID_DISC),
       0.0,
       kDisc,
       0,
       H::SILENT,
       0.05,
       "silent"},  // 0.02
      {"gimbals_noisy",
       "prototype_b",
       {},
       fault(R::SENSOR_NOISY, S::VALID_GIMBALS, 0.01),
       0.0,
       kGimbals,
       0,
       H::DISAGREES,
       0.2,
       "gimbal encoders"},  // 0.104
      {"rotors_biased",
       "prototype_b",
       {},
       fault(R::SENSOR_BIASED, S::VALID_ROTORS, -50.0),
       0.0,
       kRotors,
       0,
       H::DISAGREES,
       0.2,
       "rotor speeds"},  // 0.104
  };
}

class HealthNames : public testing::TestWithParam<Fault> {};

TEST_P(HealthNames, TheFault) {
  const Fault& fault = GetParam();
  TwinBench bench(fault.rig, fault.of_rig, {"loop.state=estimate"});
  if (fault.request) {
    ASSERT_TRUE(bench.run(1.5));
    ASSERT_EQ(bench.said.verdict, +health_t::AGREES) << bench.text();
    ASSERT_TRUE(bench.ask(*fault.request, request_t::FAULT));
  } else {
    ASSERT_TRUE(bench.run(1.0));  // settled
  }
  if (fault.push > 0.0) {
    ASSERT_TRUE(bench.run(0.2));
    bench.push(fault.push);
  }
  const auto named = [&](const health_t& said) {
    return said.verdict == health_t::DISAGREES && said.blame == fault.blame &&
           said.blamed_index == fault.index &&
           (fault.sensor_verdict == health_t::NONE ||
            said.sensor_verdict[fault.blame - health_t::SENSOR] == fault.sensor_verdict);
  };
  const double took = bench.run_until(named, fault.within_s);
  EXPECT_GE(took, 0.0) << "after " << fault.within_s << " s: " << bench.text();
  EXPECT_NE(bench.text().find(fault.word), std::string::npos) << bench.text();
  RecordProperty("milliseconds", static_cast<int>(1e3 * took));
}

INSTANTIATE_TEST_SUITE_P(Of, HealthNames, testing::ValuesIn(faults()),
                         [](const auto& fault) { return std::string(fault.param.name); });

// Insane readings do not come from a schedule of faults: a device may send them.
TEST(Health, NamesWhatIsInsane) {
  TwinBench bench("double_brennan");
  ASSERT_TRUE(bench.run(1.5));
  for (int k = 0; k < 5; ++k) {
    ++bench.tick;
    bench.sensors.header.tick = bench.tick;
    bench.sensors.gimbal_angle_rad[1] = std::nan("");
    bench.follower.step(bench.sensors, bench.commanded);
    bench.health.take(bench.follower, bench.sensors, bench.commanded);
  }
  bench.health.fill(bench.said);
  EXPECT_EQ(bench.said.sensor_verdict[3], +health_t::INSANE);
  EXPECT_EQ(bench.said.blame, kGimbals);
  EXPECT_EQ(bench.text(), "gimbal encoders: says what is no number");
}

TEST(Health, APushIsNoFault) {
  for (const char* name : {"double_brennan", "brennan_monorail", "gyrocar"}) {
    TwinBench bench(name, {}, {"loop.state=estimate"});
    ASSERT_TRUE(bench.run(1.5));
    bench.push();
    bool seen = false;
    for (int k = 0; k < 1500; ++k) {
      ASSERT_TRUE(bench.step());
      ASSERT_EQ(bench.said.verdict, +health_t::AGREES) << name << ": " << bench.text();
      seen |= bench.said.blame == health_t::EXTERNAL_MOMENT;
    }
    EXPECT_TRUE(seen) << name;
    EXPECT_EQ(bench.said.blame, +health_t::NOBODY) << name << ": " << bench.text();
  }
}

// A twin that joins under way finds the rig anywhere in its swing.
TEST(Health, AStartInMidSwingIsNoFault) {
  for (int k = 1; k <= 6; ++k) {
    TwinBench bench("gyrocar", {}, {"loop.state=estimate"});
    ASSERT_TRUE(bench.run(1.2));
    bench.push(k % 2 == 0 ? 0.5 : 1.0);
    ASSERT_TRUE(bench.run(0.05 + 0.06 * k));
    Follower follower(bench.rig, bench.machine);
    Health health(bench.rig, bench.machine);
    follower.start(bench.sensors);
    for (int i = 0; i < 1500; ++i) {
      ASSERT_TRUE(bench.step());
      follower.step(bench.sensors, bench.commanded);
      health.take(follower, bench.sensors, bench.commanded);
      follower.distrust(health.distrusted());
      health_t said{};
      health.fill(said);
      ASSERT_NE(said.verdict, +health_t::DISAGREES) << k << ": " << get_text(said.text);
    }
    EXPECT_EQ(follower.losses(), 0) << k;
  }
}

TEST(Health, TakesItBackWhenItIsOver) {
  TwinBench bench("double_brennan", {}, {"loop.state=estimate"});
  ASSERT_TRUE(bench.run(1.5));
  request_t request = fault(request_t::SENSOR_DROPPED, sensors_t::VALID_ACCELEROMETER);
  request.duration_ns = 500'000'000;
  ASSERT_TRUE(bench.ask(request, request_t::FAULT));
  ASSERT_TRUE(bench.run(0.4));
  EXPECT_EQ(bench.said.sensor_verdict[1], +health_t::SILENT);
  EXPECT_EQ(bench.said.verdict, +health_t::DISAGREES);
  ASSERT_TRUE(bench.run(1.0));
  EXPECT_EQ(bench.said.sensor_verdict[1], +health_t::AGREES);
  EXPECT_EQ(bench.said.verdict, +health_t::AGREES) << bench.text();
}

TEST(Health, HasNoVerdictWhileItSettlesNorOnWhatIsNotThere) {
  TwinBench bench("double_brennan");
  ASSERT_TRUE(bench.run(0.9));
  EXPECT_EQ(bench.said.verdict, +health_t::NONE);
  ASSERT_TRUE(bench.run(0.3));
  EXPECT_EQ(bench.said.verdict, +health_t::AGREES);
  EXPECT_EQ(bench.said.sensor_verdict[2], +health_t::NONE);  // no disc
  EXPECT_EQ(bench.said.sensor_verdict[7], +health_t::NONE);  // no load cell
  EXPECT_EQ(bench.text(), "agrees");
}

TEST(Health, ALossIsNoneOfTheNextRun) {
  TwinBench bench("double_brennan");
  ASSERT_TRUE(bench.run(1.5));
  sensors_t wild = bench.sensors;
  for (int k = 0; k < 500 && bench.follower.losses() == 0; ++k) {
    ++wild.header.tick;
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    for (double& x : wild.gyro_rad_s) x = sign * (20.0 + k);
    for (double& x : wild.acceleration_m_s2) x = -sign * (50.0 + k);
    for (double& x : wild.gimbal_angle_rad) x = sign * (1.0 + 0.01 * k);
    bench.follower.step(wild, bench.commanded);
    bench.health.take(bench.follower, wild, bench.commanded);
  }
  ASSERT_GT(bench.follower.losses(), 0);
  bench.health.fill(bench.said);
  EXPECT_EQ(bench.said.verdict, +health_t::DISAGREES);

  // As the mirror begins another run.
  bench.health.reset();
  bench.follower.distrust(0);
  const int before = bench.follower.losses();
  bench.follower.start(bench.sensors);
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(bench.step());
    ASSERT_EQ(bench.said.verdict, +health_t::NONE) << k << ": " << bench.text();
  }
  EXPECT_EQ(bench.follower.losses(), before);
}

}  // namespace
}  // namespace gyrotwin
