// Forecasts: courses against the plant, and in short what forecast_figures does at length.
#include "services/mirror/forecast.hpp"

#include <gtest/gtest.h>

#include "services/integrator/plant.hpp"
#include "tests/mirror/falls.hpp"
#include "tests/support/twin_bench.hpp"

namespace gyrotwin {
namespace {

using support::Fate;
using support::Trouble;

/// The owner's plant under the law, sampled; from a push at rest.
double plant_peak(const Rig& rig, double push_nms, double seconds) {
  const model::Machine machine = rig.build_machine();
  Plant plant(machine, rig.loop.tick_s(), {.substeps = rig.loop.substeps});
  SampledLaw law(rig, machine);
  plant.set_state(rig.initial_state(machine));
  law.reset(machine.observe(plant.state()));
  double peak = 0.0;
  const double tick = rig.loop.tick_s();
  for (double t = 0.0; t < seconds; t += tick) {
    model::Input input;
    input.drive = law.step(machine.observe(plant.state()));
    // As the course has it: a moment that fades.
    input.moment.x() = push_nms / 0.02 * std::exp(-(t + 0.5 * tick) / 0.02);
    if (!plant.advance(input)) return HUGE_VAL;
    peak = std::max(peak, machine.tilt(plant.state()));
  }
  return peak;
}

/// A tick of one who keeps up, under the law. @return whether there is a new forecast
bool step(Forecast& forecast, const Follower& follower, const header_t& at) {
  forecast.follow(follower.estimate(), at, nullptr);
  return forecast.work(follower);
}

class CourseOf : public testing::TestWithParam<const char*> {};

TEST_P(CourseOf, TheReferencePushIsThePlants) {
  const Rig rig = load_rig(GetParam());
  const model::Machine machine = rig.build_machine();
  const std::unique_ptr<Law> law = make_law(rig);
  Outset outset;
  outset.state = rig.initial_state(machine);
  outset.memory = law->start(machine.observe(outset.state));
  outset.fade_s = 0.02;
  outset.fading_moment.x() = rig.reference_impulse_nms / outset.fade_s;
  Course course(rig, 2.0, coarsest_step(rig));
  course.begin(outset);
  while (course.advance()) {
  }
  EXPECT_FALSE(course.outcome().falls());
  EXPECT_NEAR(course.outcome().peak_tilt, plant_peak(rig, rig.reference_impulse_nms, 2.0), 0.012);
}

INSTANTIATE_TEST_SUITE_P(Rigs, CourseOf,
                         testing::Values("prototype_a", "prototype_b", "prototype_b_sleeping",
                                         "double_brennan", "gyrocar", "brennan_monorail"),
                         [](const auto& test) { return std::string(test.param); });

/// When the owner's plant has fallen, braked from a push at rest [s].
double plant_falls_braked(const Rig& rig, double push_nms) {
  const model::Machine machine = rig.build_machine();
  Plant plant(machine, rig.loop.tick_s(), {.substeps = 64});
  plant.set_state(rig.initial_state(machine));
  SafeStop safe_stop(rig, machine);
  safe_stop.begin(plant.state());
  const double tick = rig.loop.tick_s();
  for (double t = 0.0; t < 2.0; t += tick) {
    if (machine.tilt(plant.state()) > rig.safety.fall_tilt_rad) return t;
    model::Input input = safe_stop.input(plant.state());
    input.moment.x() = push_nms / 0.02 * std::exp(-(t + 0.5 * tick) / 0.02);
    if (!plant.advance(input)) return HUGE_VAL;
  }
  return HUGE_VAL;
}

// Pushed hard, the brakes are at their torque limit and give way.
TEST(Course, ABrakedFallIsThePlants) {
  const Rig rig = load_rig("double_brennan");
  ASSERT_EQ(rig.safety.drive, SafeStopDrive::kBrake);
  Course course(rig, 2.0, coarsest_step(rig));
  for (const double share : {0.0, 1.0, 2.0}) {
    const double push = share * rig.reference_impulse_nms;
    Outset outset;
    outset.state = outset.stopped_from = rig.initial_state(rig.build_machine());
    outset.lawful = false;
    outset.fade_s = 0.02;
    outset.fading_moment.x() = push / outset.fade_s;
    course.begin(outset);
    while (course.advance()) {
    }
    EXPECT_NEAR(course.outcome().fell_at, plant_falls_braked(rig, push), 0.05) << push << " N m s";
  }
}

const Trouble& trouble(std::string_view name, std::string_view rig) {
  for (const Trouble& one : support::troubles()) {
    if (one.name == name && one.rig == rig) return one;
  }
  throw std::out_of_range("no such trouble");
}

TEST(Forecast, FallsAreForecastAheadAndStandingRigsNever) {
  int falls = 0, ahead = 0, stands = 0, in_vain = 0;
  for (const auto& [name, rig] :
       {std::pair{"step", "double_brennan"}, std::pair{"controller killed", "double_brennan"},
        std::pair{"push", "brennan_monorail"}}) {
    for (std::uint64_t seed = 5000; seed < 5006; ++seed) {
      const Fate run = support::run_trouble(trouble(name, rig), seed);
      if (run.fell_at < 0.0) {
        ++stands;
        in_vain += support::false_alarm(run);
      } else {
        ++falls;
        ahead += support::lead(run) >= 0.3;
      }
    }
  }
  EXPECT_GE(falls, 6);
  EXPECT_GE(stands, 6);
  EXPECT_GE(ahead, falls - 1);
  EXPECT_EQ(in_vain, 0);
}

TEST(Forecast, ComesOftenEnoughAndIsYoung) {
  support::MirroredLoop loop("prototype_b", {"loop.state=estimate"});
  loop.hear();
  ASSERT_EQ(loop.ask(request_t::ARM).result, reply_t::APPLIED);
  loop.run_seconds(1.5);
  int told = 0;
  std::int64_t sequence = -1;
  for (int k = 0; k < 1000; ++k) {
    loop.tick();
    if (!loop.forecast_told) continue;
    ++told;
    EXPECT_LE(loop.forecast.age_ns, 50'000'000);
    if (sequence >= 0) {
      EXPECT_EQ(loop.forecast.header.sequence, sequence + 1);
    }
    sequence = loop.forecast.header.sequence;
    EXPECT_EQ(loop.forecast.law, 1);
  }
  EXPECT_GE(told, 20) << "in a second";
}

TEST(Forecast, IsToldWhereTheEstimateBeginsBeyondTheLimit) {
  const Rig rig = load_rig("double_brennan");
  const model::Machine machine = rig.build_machine();
  sensors_t lying{};
  lying.valid = sensors_t::VALID_ACCELEROMETER;
  const Eigen::Vector3d up(0.0, 0.8, 0.6);
  const Eigen::Vector3d felt = machine.gravity * rig.sensors->imu_axes().transpose() * up;
  for (int i = 0; i < 3; ++i) lying.acceleration_m_s2[i] = felt[i];
  Follower follower(rig, machine);
  follower.start(lying);
  ASSERT_GT(machine.tilt(follower.estimate().state), rig.safety.fall_tilt_rad);

  Forecast forecast(rig, machine);
  int told = 0;
  header_t at{};
  const auto second = std::llround(rig.loop.rate_hz);
  const auto next = [&] {
    ++at.tick;
    at.sim_time_ns = std::llround(1e9 * rig.loop.tick_s() * static_cast<double>(at.tick));
    return step(forecast, follower, at);
  };
  for (int k = 0; k < second; ++k) told += next();
  EXPECT_GE(told, 20) << "in a second";
  forecast_t last{};
  forecast.fill(last);
  EXPECT_EQ(last.outcome, forecast_t::FALLS);
  EXPECT_EQ(last.falls_in_ns, 0);

  // And it goes on once the rig stands.
  follower.start({});
  told = 0;
  for (int k = 0; k < second; ++k) told += next();
  EXPECT_GE(told, 20) << "in a second";
  forecast.fill(last);
  EXPECT_GT(last.tilt_margin_rad, 0.0);
}

TEST(Forecast, NothingIsForecastOfWhatHasFallen) {
  support::MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  loop.hear();
  ASSERT_EQ(loop.ask(request_t::ARM).result, reply_t::APPLIED);
  loop.run_seconds(1.5);
  loop.controller_alive = false;
  bool alarm = false;
  for (int k = 0; k < 5000 && loop.integrator.mode() != Mode::kFallen; ++k) {
    loop.tick();
    if (loop.forecast_told) alarm = loop.forecast.outcome == forecast_t::FALLS;
  }
  ASSERT_EQ(loop.integrator.mode(), Mode::kFallen);
  EXPECT_TRUE(alarm);
  for (int k = 0; k < 500; ++k) {
    loop.tick();
    EXPECT_FALSE(loop.forecast_told);
  }
  health_t health;
  loop.mirror.fill(health);
  EXPECT_EQ(health.verdict, health_t::NONE) << "what lies on the ground is not judged";
}

/// Forecasts in a second.
int forecasts(support::MirroredLoop& loop) {
  int told = 0;
  for (auto n = std::llround(loop.rig.loop.rate_hz); n > 0; --n) {
    loop.tick();
    told += loop.forecast_told;
  }
  return told;
}

TEST(Forecast, ATwinThatItsSensorsContradictForecastsNothing) {
  support::MirroredLoop loop("double_brennan", {"loop.state=estimate"});
  loop.hear();
  ASSERT_EQ(loop.ask(request_t::ARM).result, reply_t::APPLIED);
  loop.run_seconds(1.5);
  EXPECT_GE(forecasts(loop), 20);
  request_t noisy{};
  noisy.verb = request_t::FAULT;
  noisy.kind = request_t::SENSOR_NOISY;
  noisy.target = sensors_t::VALID_GIMBALS;
  noisy.level = 0.1;
  ASSERT_EQ(loop.ask(noisy).result, reply_t::APPLIED);
  loop.run_seconds(0.5);
  EXPECT_EQ(forecasts(loop), 0);
  ASSERT_EQ(loop.ask(request_t::CLEAR).result, reply_t::APPLIED);
  loop.run_seconds(1.0);
  EXPECT_GE(forecasts(loop), 20);
}

TEST(Forecast, WhoIsBehindForecastsLaterAndForgetsNothing) {
  support::TwinBench bench("prototype_b");
  Forecast prompt(bench.rig, bench.machine), behind(bench.rig, bench.machine);
  int told = 0, told_late = 0;
  forecast_t one{}, other{};
  for (int k = 0; k < 2000; ++k) {
    ASSERT_TRUE(bench.step());
    told += step(prompt, bench.follower, bench.sensors.header);
    behind.follow(bench.follower.estimate(), bench.sensors.header, nullptr);
    if (k % 4 == 0) told_late += behind.work(bench.follower);
  }
  prompt.fill(one);
  behind.fill(other);
  EXPECT_GE(told, 40);
  EXPECT_GE(told_late, 10);
  EXPECT_LT(told_late, told);
  EXPECT_NEAR(one.final_tilt_rad, other.final_tilt_rad, 2e-3);
}

TEST(Forecast, AnotherRunRemembersNothingOfTheLaw) {
  support::TwinBench bench("prototype_b");
  ASSERT_GT(make_law(bench.rig)->states(), 0);
  bench.disturb = [](support::TwinBench& of, model::Input& input) {
    input.moment.x() = 0.2 * of.rig.reference_impulse_nms;
  };
  Forecast used(bench.rig, bench.machine), fresh(bench.rig, bench.machine);
  for (int k = 0; k < 700; ++k) {
    ASSERT_TRUE(bench.step());
    step(used, bench.follower, bench.sensors.header);
  }
  used.reset();
  int told = 0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(bench.step());
    const bool told_anew = step(used, bench.follower, bench.sensors.header);
    ASSERT_EQ(step(fresh, bench.follower, bench.sensors.header), told_anew);
    if (!told_anew) continue;
    ++told;
    forecast_t one{}, other{};
    used.fill(one);
    fresh.fill(other);
    EXPECT_EQ(one.peak_tilt_rad, other.peak_tilt_rad);
    EXPECT_EQ(one.final_tilt_rad, other.final_tilt_rad);
  }
  EXPECT_GE(told, 5);
}

}  // namespace
}  // namespace gyrotwin
