// What a trial keeps of a run is the most of all ticks.
#include "clients/simulate/trial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clients/common/event.hpp"

namespace gyrotwin {
namespace {

/// Every tick's truth, kept.
class Everything : public Spectator {
 public:
  explicit Everything(const model::Machine& machine) : machine_(machine) {}
  void sample(const Sample& sample) override {
    const model::Truth truth = machine_.truth(sample.state, sample.input);
    ++ticks;
    for (const double torque : truth.drive_torque) drive = std::max(drive, std::abs(torque));
    holding = std::max(holding, std::hypot(truth.holding_moment[0], truth.holding_moment[1]));
    margin = std::min(margin, truth.gimbal_margin);
    tilt = std::max(tilt, machine_.tilt(sample.state));
  }
  bool go_on(const Outcome&) override { return true; }

  int ticks = 0;
  double drive = 0.0, holding = 0.0, tilt = 0.0;
  double margin = std::numeric_limits<double>::infinity();

 private:
  const model::Machine& machine_;
};

TEST(Trial, KeepsTheMostOfAllTicks) {
  const Rig rig = load_rig("prototype_b");
  const model::Machine machine = rig.build_machine();
  Scenario scenario = live_scenario(rig, machine, 0.4);
  AskedEvent push;
  push.kind = event_kind("impulse");
  request_t request = request_of(push, rig, rig.loop.tick_ns());
  request.start_tick = 200;
  scenario.events = {{request, "push"}};

  const Trial trial = run_trial(rig, machine, scenario);
  Scenario every = scenario;
  every.sample = rig.loop.tick_s();
  Everything all(machine);
  simulate(rig, machine, every, all);
  EXPECT_EQ(all.ticks, 401);
  EXPECT_EQ(trial.largest_torque, all.drive);
  EXPECT_EQ(trial.largest_holding_moment, all.holding);
  EXPECT_EQ(trial.least_gimbal_margin, all.margin);
  EXPECT_EQ(trial.largest_tilt, all.tilt);
  EXPECT_GT(all.holding, 100.0);
}

/// Where each run of a sweep is, tick by tick.
class Path : public Spectator {
 public:
  void sample(const Sample& sample) override { q.push_back(sample.state.q); }
  bool go_on(const Outcome&) override { return true; }
  std::vector<model::Coordinates> q;
};

class QuickSteps : public testing::TestWithParam<std::pair<const char*, double>> {};

/// In closed loop, in contact too: a second from a tilt of 0.02 rad. With each rig its largest
/// error, measured [rad].
TEST_P(QuickSteps, AreOffByLittle) {
  const auto [name, measured] = GetParam();
  const Rig rig = load_rig(name);
  const model::Machine machine = rig.build_machine();
  Scenario scenario = live_scenario(rig, machine, 1.0);
  scenario.start.q[0] += 0.02;
  Path exact, quick;
  scenario.stepping.kind = StepPolicy::Kind::kAdaptive;
  simulate(rig, machine, scenario, exact);
  scenario.stepping.kind = StepPolicy::Kind::kQuick;
  simulate(rig, machine, scenario, quick);
  ASSERT_EQ(quick.q.size(), exact.q.size());
  double error = 0.0;
  for (std::size_t k = 0; k < exact.q.size(); ++k) {
    error = std::max(error, (quick.q[k] - exact.q[k]).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(error, 3.0 * measured);
  EXPECT_GT(error, 0.03 * measured);
}

INSTANTIATE_TEST_SUITE_P(Rigs, QuickSteps,
                         testing::Values(std::pair("prototype_b", 3e-7),
                                         std::pair("prototype_b_sleeping", 3e-9),
                                         std::pair("double_brennan", 5e-8),
                                         std::pair("brennan_monorail", 5e-8)),
                         [](const auto& test) { return std::string(test.param.first); });

TEST(Trial, CountsDrivesAtTheirLimitAndSlowRotors) {
  Rig rig = load_rig("double_brennan");
  rig.initial_rotor_share = 0.3;
  const model::Machine machine = rig.build_machine();
  Scenario scenario = live_scenario(rig, machine, 0.05);
  EXPECT_DOUBLE_EQ(run_trial(rig, machine, scenario).first_rotor_share, 0.3);
  scenario.start.q[0] = 0.3;  // asks for more than any drive has
  const Trial pinned = run_trial(rig, machine, scenario);
  EXPECT_GT(pinned.at_limit, 0.5);
  EXPECT_DOUBLE_EQ(pinned.largest_torque, machine.drives[0].torque_limit);
  scenario.start.q.setZero();
  scenario.start.v.setZero();
  EXPECT_EQ(run_trial(rig, machine, scenario).at_limit, 0.0);
}

TEST(Trial, HasNoTiltWhereNothingTilts) {
  const Rig rig = load_rig("simple_gyroscope");
  const model::Machine machine = rig.build_machine();
  const Trial trial = run_trial(rig, machine, live_scenario(rig, machine, 0.5));
  EXPECT_TRUE(trial.stood());
  EXPECT_EQ(trial.largest_tilt, 0.0);
  EXPECT_EQ(trial.end_tilt, 0.0);
  EXPECT_GT(trial.least_gimbal_margin, 0.3);
}

}  // namespace
}  // namespace gyrotwin
