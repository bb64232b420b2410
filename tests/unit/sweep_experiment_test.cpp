// One run of a sweep: what it is told, what it refuses, and how it is shown again.
#include <gtest/gtest.h>

#include <algorithm>

#include "clients/sweep/experiment.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

Experiment experiment(Bench bench, const std::vector<std::string>& vary) {
  Plan plan;
  for (const std::string& text : vary) plan.variables.push_back(parse_variable(text));
  return Experiment(std::move(bench), std::move(plan));
}

std::string refusal(const std::vector<std::string>& vary) {
  try {
    experiment({.rig = "double_brennan", .overrides = {}, .duration = 0.1}, vary);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(Experiment, RefusesAStartThatIsNoNumber) {
  EXPECT_NE(refusal({"start.thx=much"}).find("takes numbers"), std::string::npos);
  EXPECT_NE(refusal({"start.thx=0.1,0.2,much"}).find("takes numbers"), std::string::npos);
  EXPECT_NE(refusal({"start.thx=]"}).find("takes numbers"), std::string::npos);
  EXPECT_NE(refusal({"start.thz=0.1"}).find("no `thz`"), std::string::npos);
  EXPECT_NE(refusal({"start.q=1,2"}).find("expected 4"), std::string::npos);
  EXPECT_EQ(refusal({"start.thx=0.1", "start.qA_dot=0.2"}), "none");
}

TEST(Experiment, StartsWhereItIsTold) {
  const Experiment lean = experiment({.rig = "double_brennan", .overrides = {}, .duration = 0.002},
                                     {"start.thx=0.1,0.3", "start.thy=-0.2"});
  EXPECT_TRUE(lean.line(0).starts_with("0,0.1,-0.2,stands,,0.22")) << lean.line(0);
  EXPECT_TRUE(lean.line(1).starts_with("1,0.3,-0.2,")) << lean.line(1);
  EXPECT_NE(lean.line(1).find(",0.35"), std::string::npos) << lean.line(1);
}

TEST(Experiment, TellsTheSameOfARunWhateverItDidBefore) {
  const Bench bench{.rig = "double_brennan", .overrides = {}, .duration = 0.1};
  const std::vector<std::string> vary{"start.thx=0.1,0.3", "structure.mass_kg=6,5"};
  const Experiment used = experiment(bench, vary);
  for (const std::int64_t run : {0, 1, 2, 3, 2, 0}) {
    EXPECT_EQ(used.line(run), experiment(bench, vary).line(run)) << run;
  }
  EXPECT_NE(used.line(0).substr(8), used.line(1).substr(8));
}

/// A gyroscope has no tilt to tell.
TEST(Experiment, LeavesEmptyWhatAMachineHasNot) {
  const Experiment nods = experiment({.rig = "simple_gyroscope", .overrides = {}, .duration = 0.1},
                                     {"start.tg_dot=0,0.1"});
  EXPECT_TRUE(nods.line(1).starts_with("1,0.1,stands,,,,0.")) << nods.line(1);
}

TEST(Experiment, SaysWhyThereIsNoSuchRig) {
  const Experiment heavy = experiment({.rig = "double_brennan", .overrides = {}, .duration = 0.002},
                                      {"structure.mass_kg=6,60"});
  EXPECT_EQ(heavy.refusal(0), "");
  EXPECT_NE(heavy.refusal(1).find("inertia_tilt_kgm2"), std::string::npos) << heavy.refusal(1);
  EXPECT_NE(heavy.line(1).find("impossible"), std::string::npos) << heavy.line(1);
}

/// Toppled onto its stops: neither stands nor falls.
TEST(Experiment, TellsWhatLeansOnItsStops) {
  const Experiment still = experiment({.rig = "prototype_b", .overrides = {}, .duration = 6.0},
                                      {"gyros.rotor_speed_rad_s=0"});
  EXPECT_TRUE(still.line(0).starts_with("0,0,leans,,")) << still.line(0);
}

/// Whole ticks, and words that a shell leaves alone.
TEST(Experiment, IsShownAgainByACommand) {
  const Experiment odd = experiment(
      {.rig = "double_brennan", .overrides = {"rig.summary=\"it's mine\""}, .duration = 0.0503},
      {"start.thx=0.1,-0.1"});
  EXPECT_EQ(odd.repeat_command(1),
            "gyrotwin simulate --rig double_brennan --set 'rig.summary=\"it'\\''s mine\"' "
            "--initial thx=-0.1 --feedback sampled --stepper quick --duration 0.05");
}

}  // namespace
}  // namespace gyrotwin
