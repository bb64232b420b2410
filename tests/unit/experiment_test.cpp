// Experiments: what they ask of a rig beforehand, and where a simulated one starts.
#include <gtest/gtest.h>

#include "clients/experiment/conduct.hpp"
#include "services/integrator/plant.hpp"

namespace gyrotwin {
namespace {

ExperimentPlan plan(std::string_view name) {
  return {.kind = &experiment_of(name), .mass_kg = 10.0, .mass_height_m = -0.4};
}

// I n' = -(b n + c) from prototype_b's 1257 rad/s with 1e-5 N m s/rad and 0.005 N m: 93 s to half.
TEST(Experiment, WatchesRotorsUntilTheyHaveLostHalfTheirSpeed) {
  const ExperimentKind& run_down = experiment_of("run-down");
  EXPECT_EQ(watched_s(run_down, load_rig("prototype_b")), 93.0);
  EXPECT_GT(watched_s(run_down, load_rig("gyrocar")), 60.0);
  EXPECT_EQ(watched_s(experiment_of("swing"), load_rig("prototype_b")), 10.0);
}

TEST(Experiment, SaysHowASimulatedRigIsArranged) {
  const Rig rig = load_rig("prototype_b");
  for (const ExperimentKind& kind : kExperiments) {
    const ExperimentPlan wanted = plan(kind.name);
    std::vector<std::string> overrides = arrangement(kind, rig);
    if (kind.rotors_at_rest) overrides.emplace_back("rotor_drive.start_share=0");
    std::string words;
    for (const std::string& key : overrides) words += " --set " + key;
    const std::string why = misfit(wanted, rig, true);
    EXPECT_EQ(why.empty(), overrides.empty()) << kind.name;
    EXPECT_NE(why.find(words), std::string::npos) << why;
    EXPECT_EQ(misfit(wanted, load_rig("prototype_b", overrides), true), "") << kind.name;
    EXPECT_EQ(misfit(wanted, rig, false), "") << kind.name;
    EXPECT_EQ(by_hand(wanted, true), "");
    EXPECT_EQ(by_hand(wanted, false).empty(), overrides.empty());
  }
}

/// The `--set` words of a text.
std::vector<std::string> set_words(const std::string& text) {
  std::vector<std::string> words;
  const std::string mark = "--set ";
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
    at += mark.size();
    words.push_back(text.substr(at, text.find(' ', at) - at));
  }
  return words;
}

TEST(Experiment, ItsWordsPassTheIntegratorsStepCheck) {
  const Rig rig = load_rig("prototype_b");
  for (const ExperimentKind& kind : kExperiments) {
    const std::string why = misfit(plan(kind.name), rig, true);
    const Rig arranged = load_rig("prototype_b", set_words(why));
    EXPECT_LE(stepping_error(arranged, arranged.build_machine()), arranged.loop.step_tolerance)
        << why;
  }
}

TEST(Experiment, ItsWordsAreAllThatIsNeeded) {
  const std::vector<std::string> given{
      "loop.rate_hz=250", "loop.substeps=1", "safety.safe_stop=hold_speed",
      "safety.safe_stop_gain_nms_per_rad=1", "initial.q=[0, 0, 0, 0]"};
  const std::string why = misfit(plan("run-down"), load_rig("prototype_b", given), true, given);
  EXPECT_NE(why.find("--set loop.rate_hz=250 "), std::string::npos) << why;
  EXPECT_NE(why.find("--set 'initial.q=[0, 0, 0, 0]'"), std::string::npos) << why;
  EXPECT_EQ(why.find("loop.substeps"), why.rfind("loop.substeps")) << why;
  std::vector<std::string> words = set_words(why);
  std::erase_if(words, [](const std::string& word) { return word.starts_with("'"); });
  EXPECT_EQ(misfit(plan("run-down"), load_rig("prototype_b", words), true, words), "");
}

TEST(Experiment, RefusesWhatTellsNothing) {
  EXPECT_NE(misfit(plan("coast-down"), load_rig("double_brennan"), true).find("tells nothing"),
            std::string::npos);
}

TEST(Experiment, WantsACounterweightThatMakesItHang) {
  ExperimentPlan light = plan("swing");
  light.mass_kg = 4.0;  // 15.7 N m/rad, and 18.1 topple it
  EXPECT_NE(misfit(light, load_rig("prototype_b"), false).find("would not swing but fall"),
            std::string::npos);
}

TEST(Experiment, RefusesASafeStopThatNoLogTells) {
  const Rig rig = load_rig("double_brennan", {"safety.safe_stop=hold_speed"});
  EXPECT_NE(misfit(plan("run-down"), rig, false).find("hold_speed"), std::string::npos);
}

TEST(Experiment, SimulatedRigsStartWhereTheyShould) {
  EXPECT_FALSE(start_of(plan("coast-down")).has_value());
  EXPECT_EQ(start_of(plan("run-down"))->initial_q[0], 0.0);
  EXPECT_EQ(start_of(plan("swing"))->initial_q[0], 0.1);
}

}  // namespace
}  // namespace gyrotwin
