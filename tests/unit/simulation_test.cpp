// The core of gyrotwin-simulate against the live system's own parts and the tests' integrator.
#include "clients/simulate/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "services/integrator/plant.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/law_rigs.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using End = Outcome::End;

struct Recorded {
  double t;
  model::State state;
  model::Input input;
};

class Recorder : public Spectator {
 public:
  void sample(const Sample& s) override {
    samples.push_back({s.t, s.state, s.input});
    if (s.estimate != nullptr) estimates.push_back(*s.estimate);
  }
  bool go_on(const Outcome& until_now) override { return until_now.t < stop_at; }

  std::vector<Recorded> samples;
  std::vector<model::Observation> estimates;
  double stop_at = 1e9;
};

struct Result {
  Outcome outcome;
  std::vector<Recorded> samples;
  const model::State& last() const { return samples.back().state; }
};

Result run(const Rig& rig, const model::Machine& machine, const Scenario& scenario) {
  Recorder recorder;
  const Outcome outcome = simulate(rig, machine, scenario, recorder);
  return {outcome, recorder.samples};
}

/// A moment about x within [begin, end).
InputFunction<Wrench> push(double begin, double end, double moment) {
  return {[=](const Instant& now) {
            Wrench wrench;
            if (begin <= now.within && now.within < end) wrench.moment.x() = moment;
            return wrench;
          },
          {begin, end}};
}

double largest(const model::Coordinates& x) { return x.cwiseAbs().maxCoeff(); }

/// Coarse enough to tell one way of stepping from another.
Rig umbrella_rig() {
  Rig rig = reference::constant_speed();
  rig.loop.substeps = 3;
  return rig;
}

Scenario sampled(const Rig& rig, const model::State& start, double duration) {
  Scenario scenario;
  scenario.start = start;
  scenario.duration = duration;
  scenario.sample = rig.loop.tick_s();
  scenario.stepping.substeps = rig.loop.substeps;
  return scenario;
}

Scenario continuous(const model::State& start, double duration, double sample) {
  Scenario scenario;
  scenario.start = start;
  scenario.duration = duration;
  scenario.sample = sample;
  scenario.sampled = false;
  scenario.stepping.kind = StepPolicy::Kind::kAdaptive;
  return scenario;
}

class SampledFeedback : public testing::TestWithParam<int> {};

TEST_P(SampledFeedback, TakesTheLiveSystemsSteps) {
  constexpr int kTicks = 500;
  Rig rig = umbrella_rig();
  rig.loop.command_delay_ticks = GetParam();
  const model::Machine machine = rig.build_machine();
  Scenario scenario =
      sampled(rig, machine.state({0.03, 0.01, 0.0, 0.02}, {0, 0, -2.0, 0}), 1e-3 * kTicks);
  scenario.external = push(0.1, 0.12, 25.0);
  const Result result = run(rig, machine, scenario);
  ASSERT_EQ(result.samples.size(), kTicks + 1u);

  SampledLaw law(rig, machine);
  Plant plant(machine, rig.loop.tick_s(), {.substeps = rig.loop.substeps});
  plant.set_state(scenario.start);
  law.reset(machine.observe(scenario.start));
  std::deque<DriveTorques> on_the_way(static_cast<std::size_t>(GetParam()), DriveTorques{});
  for (int k = 0; k < kTicks; ++k) {
    on_the_way.push_back(law.step(machine.observe(plant.state())));
    model::Input input;
    input.drive = on_the_way.front();
    on_the_way.pop_front();
    if (100 <= k && k < 120) input.moment.x() = 25.0;
    ASSERT_TRUE(plant.advance(input));
    const Recorded& sample = result.samples[static_cast<std::size_t>(k + 1)];
    ASSERT_EQ(sample.state.q, plant.state().q) << "tick " << k;
    ASSERT_EQ(sample.state.v, plant.state().v) << "tick " << k;
    ASSERT_EQ(sample.input.drive, input.drive) << "tick " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(DelayTicks, SampledFeedback, testing::Values(0, 1, 4));

TEST(SampledFeedback, HoldsATorqueFunctionOverTheTick) {
  const Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  Scenario scenario = sampled(rig, machine.state({0, 0, 0, 0}, {0, 0, -2.0, 0}), 0.005);
  scenario.torque = InputFunction<DriveTorques>{
      [](const Instant& now) { return DriveTorques{now.t < 0.003 ? 1.0 : 2.0}; }, {}};
  const Result result = run(rig, machine, scenario);
  for (std::size_t k = 1; k < result.samples.size(); ++k) {
    EXPECT_EQ(result.samples[k].input.drive[0], k <= 3 ? 1.0 : 2.0) << k;
  }
}

TEST(SampledFeedback, ApproachesContinuousFeedbackAsTheTickShrinks) {
  Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  const model::State start = machine.state({0.0, 0.0, 0.0, 0.0}, {0, 0, -4.5, 0});
  const model::State limit = run(rig, machine, continuous(start, 0.2, 0.2)).last();
  std::vector<double> errors;
  for (const double rate : {1000.0, 2000.0}) {
    rig.loop.rate_hz = rate;
    errors.push_back(largest(run(rig, machine, sampled(rig, start, 0.2)).last().q - limit.q));
  }
  EXPECT_LT(errors[0], 1e-4);                             // measured 2.2e-5
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1, 0.2);  // measured 1.05
}

TEST(ContinuousFeedback, IntegratesTheLawsMemory) {
  // With an integral: the same loop by hand, its memory as one more state.
  const Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  const model::State start = machine.state({0.0, 0.0, 0.0, 0.0}, {0, 0, -4.5, 0});
  const auto& c = rig.controller;
  // z' = ki (-Om0 - phi'), so z = ki (-Om0 t - phi) below its limit, phi(0) = 0.
  const model::State expected = reference::simulate(
      machine, start, 0.2,
      [&](double t, const model::State& s) {
        model::Input input;
        input.drive[0] = *c.kp * (-*c.disc_speed - s.v[2]) + *c.ki * (-*c.disc_speed * t - s.q[2]);
        return input;
      },
      {1e-12, 1e-13});
  const model::State found = run(rig, machine, continuous(start, 0.2, 0.05)).last();
  EXPECT_LT(largest(found.q - expected.q), 1e-12);  // measured 1.4e-14
  EXPECT_LT(largest(found.v - expected.v), 1e-10);  // measured 1.5e-12
}

TEST(Breakpoints, AreMetExactlyWhereverTheyLie) {
  const Rig rig = reference::double_brennan();
  const model::Machine machine = rig.build_machine();
  const model::State start = machine.state({0.01, 0, 0, 0}, {0, 0, 0, 0});
  constexpr double kBegin = 0.01234, kEnd = 0.0288, kMoment = 40.0;
  const auto piece = [&](const model::State& from, double duration, double moment) {
    return reference::simulate(machine, from, duration,
                               [&](double, const model::State&) {
                                 model::Input input;
                                 input.moment.x() = moment;
                                 return input;
                               },
                               {1e-13, 1e-14});
  };
  const model::State expected =
      piece(piece(piece(start, kBegin, 0.0), kEnd - kBegin, kMoment), 0.1 - kEnd, 0.0);

  Scenario adaptive = continuous(start, 0.1, 0.1);
  Scenario fixed = sampled(rig, start, 0.1);
  fixed.stepping.substeps = 20;
  for (Scenario* scenario : {&adaptive, &fixed}) {
    scenario->external = push(kBegin, kEnd, kMoment);
    scenario->torque =
        InputFunction<DriveTorques>{[](const Instant&) { return DriveTorques{}; }, {}};
    const model::State found = run(rig, machine, *scenario).last();
    EXPECT_LT(largest(found.q - expected.q), 1e-12);  // measured 3.7e-14
    EXPECT_LT(largest(found.v - expected.v), 1e-10);  // measured 5.3e-12
  }
}

TEST(Breakpoints, AFunctionMayJumpBetweenThem) {
  const Rig rig = reference::double_brennan();
  const model::Machine machine = rig.build_machine();
  Scenario told = continuous(machine.state({0.01, 0, 0, 0}, {0, 0, 0, 0}), 0.1, 0.1);
  told.external = push(0.01234, 0.0288, 40.0);
  Scenario untold = told;
  untold.external.breakpoints.clear();
  untold.external.value = [](const Instant& now) {
    Wrench wrench;
    if (0.01234 <= now.t && now.t < 0.0288) wrench.moment.x() = 40.0;
    return wrench;
  };
  const Result a = run(rig, machine, told), b = run(rig, machine, untold);
  ASSERT_EQ(b.outcome.end, End::kDuration);
  EXPECT_LT(largest(a.last().q - b.last().q), 1e-9);  // measured 7.7e-11
}

TEST(Samples, FallOnMultiplesOfTheSamplingTime) {
  const Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  Scenario scenario = continuous(machine.state({}, {}), 0.35, 0.025);
  const Result free = run(rig, machine, scenario);
  ASSERT_EQ(free.samples.size(), 15u);
  for (std::size_t k = 0; k < free.samples.size(); ++k) {
    EXPECT_EQ(free.samples[k].t, static_cast<double>(k) * 0.025);
  }
  scenario.sample.reset();
  EXPECT_EQ(run(rig, machine, scenario).samples[1].t, 0.01);
}

TEST(Samples, EndWithTheDuration) {
  const Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  const model::State start = machine.state({0.01}, {0, 0, -2.0, 0});
  const auto times = [&](const Scenario& scenario) {
    std::vector<double> found;
    for (const Recorded& sample : run(rig, machine, scenario).samples) found.push_back(sample.t);
    return found;
  };
  const auto expect_times = [](const std::vector<double>& found, const std::vector<double>& known) {
    ASSERT_EQ(found.size(), known.size());
    for (std::size_t k = 0; k < known.size(); ++k) EXPECT_NEAR(found[k], known[k], 1e-15) << k;
  };
  expect_times(times(continuous(start, 0.25, 0.1)), {0.0, 0.1, 0.2, 0.25});
  expect_times(times(continuous(start, 0.2537, 0.1)), {0.0, 0.1, 0.2, 0.2537});
  expect_times(times(continuous(start, 0.004, 0.1)), {0.0, 0.004});
  Scenario in_ticks = sampled(rig, start, 0.25);
  in_ticks.sample = 0.1;
  expect_times(times(in_ticks), {0.0, 0.1, 0.2, 0.25});

  // The last row is of that time, not only named so.
  const model::State cut = run(rig, machine, continuous(start, 0.0537, 0.02)).last();
  const model::State whole = run(rig, machine, continuous(start, 0.0537, 0.0537)).last();
  EXPECT_LT(largest(cut.q - whole.q), 1e-12);  // measured 5.5e-14
}

TEST(Samples, FallOnTicksWhereThereAreTicks) {
  Rig rig = umbrella_rig();
  rig.loop.rate_hz = 400.0;  // ticks of 2.5 ms
  const model::Machine machine = rig.build_machine();
  Scenario scenario = sampled(rig, machine.state({}, {}), 0.1);
  const auto refusal = [&](double sample) {
    scenario.sample = sample;
    try {
      run(rig, machine, scenario);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal(0.005), "accepted");
  EXPECT_NE(
      refusal(0.006).find("ticks of 0.0025 s here; the nearest that fit are 0.005 and 0.0075"),
      std::string::npos)
      << refusal(0.006);
  EXPECT_NE(refusal(0.001).find("that fit are 0.0025 ("), std::string::npos) << refusal(0.001);
  scenario.duration = 0.101;
  EXPECT_NE(
      refusal(0.005).find("--duration 0.101: time goes in ticks of 0.0025 s here; the nearest "
                          "that fit are 0.1 and 0.1025"),
      std::string::npos)
      << refusal(0.005);
  scenario.duration = 0.1;
  scenario.sampled = false;
  scenario.torque = InputFunction<DriveTorques>{[](const Instant&) { return DriveTorques{}; }, {}};
  EXPECT_NE(refusal(0.006), "accepted") << "fixed steps are a tick's";
  scenario.stepping.kind = StepPolicy::Kind::kAdaptive;
  EXPECT_EQ(refusal(0.006), "accepted");
  scenario.stepping.kind = StepPolicy::Kind::kQuick;
  EXPECT_NE(refusal(0.005).find("they need sampled feedback"), std::string::npos);
}

TEST(Samples, TakeTicksThatAreRoundedToNanosecondsForWhatIsMeant) {
  Rig rig = umbrella_rig();
  rig.loop.rate_hz = 7000.0;  // ticks of 142857 ns, which miss 0.1 s by 0.1 us
  const model::Machine machine = rig.build_machine();
  Scenario scenario = sampled(rig, machine.state({}, {}), 0.1);
  scenario.sample = 0.05;
  EXPECT_EQ(run(rig, machine, scenario).samples.size(), 3u);
}

TEST(Ends, SayWhyAndWhen) {
  Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  Scenario scenario = continuous(machine.state({0.05}, {}), 2.0, 0.01);
  scenario.torque = InputFunction<DriveTorques>{
      [](const Instant& now) { return DriveTorques{now.within < 0.05 ? 0.0 : HUGE_VAL}; }, {0.05}};
  Result result = run(rig, machine, scenario);
  EXPECT_EQ(result.outcome.end, End::kInputNotFinite);
  EXPECT_NEAR(result.outcome.t, 0.05, 1e-12);
  EXPECT_EQ(result.samples.size(), 6u);

  scenario.torque->value = [](const Instant&) { return DriveTorques{1e308}; };
  result = run(rig, with_ideal_drives(machine), scenario);
  EXPECT_EQ(result.outcome.end, End::kNotFinite);
  EXPECT_TRUE(result.last().finite());

  Recorder recorder;
  recorder.stop_at = 0.495;
  scenario.torque->value = [](const Instant&) { return DriveTorques{}; };
  const Outcome stopped = simulate(rig, machine, scenario, recorder);
  EXPECT_EQ(stopped.end, End::kStopped);
  EXPECT_NEAR(stopped.t, 0.5, 1e-12);
}

TEST(Ends, AFallIsNoticedAndGoesOn) {
  Rig rig = reference::constant_speed();
  rig.controller.law = LawKind::kNone;
  rig.safety.fall_tilt_rad = 0.5;
  std::get<model::UmbrellaParameters>(rig.machine).mount = model::Mount::kRigid;
  const model::Machine machine = rig.build_machine();
  const Result result = run(rig, machine, continuous(machine.state({0.1}, {}), 1.0, 0.001));
  ASSERT_TRUE(result.outcome.verdict.fell_at().has_value());
  EXPECT_EQ(result.outcome.end, End::kDuration);
  EXPECT_NEAR(result.outcome.t, 1.0, 1e-12);
  double before = 0.0, after = 0.0;  // tilt at the samples around
  for (const Recorded& sample : result.samples) {
    const double tilt = machine.tilt(sample.state);
    if (sample.t <= *result.outcome.verdict.fell_at()) before = tilt;
    if (sample.t > *result.outcome.verdict.fell_at() && after == 0.0) after = tilt;
  }
  EXPECT_LE(before, 0.5);
  EXPECT_GE(after, 0.5);
  EXPECT_GE(result.outcome.verdict.largest_tilt(), after);
}

TEST(IdealDrives, GiveAnyTorqueAtAnySpeed) {
  const Rig rig = umbrella_rig();
  const model::Machine machine = rig.build_machine();
  const model::Machine ideal = with_ideal_drives(machine);
  const model::State fast = machine.state({}, {0, 0, -1000.0, 0});
  model::Input input, unlimited;
  input.drive[0] = unlimited.drive[0] = 500.0;
  unlimited.mode = model::DriveMode::kIdealTorque;
  EXPECT_EQ(ideal.acceleration(fast, input), machine.acceleration(fast, unlimited));
  EXPECT_NE(machine.acceleration(fast, input), machine.acceleration(fast, unlimited));
}

}  // namespace
}  // namespace gyrotwin
