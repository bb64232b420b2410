// Both owners in random scenarios, step by step against tests/support/owner_model.hpp: commands
// good and bad, requests of every verb, time, trouble with the device. Whatever happens, no torque
// acts but that of a fresh, authentic, finite command of the one writer, within limits, while
// RUNNING.
#include <gtest/gtest.h>

#include "tests/support/hardware_scenario.hpp"
#include "tests/support/integrator_scenario.hpp"

namespace gyrotwin {
namespace {

using support::HardwareScenario;
using support::IntegratorScenario;

constexpr int kSteps = 100'000;

template <class Scenario, class AnOwner>
void hold(const std::vector<std::string>& overrides, std::uint64_t seed,
          const std::vector<Mode>& modes) {
  std::vector<std::string> all{"safety.safe_stop=zero_torque"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  const Rig rig = load_rig("prototype_b", all);
  AnOwner owner(rig, 1);
  Scenario scenario(seed, rig, owner);
  try {
    scenario.run(kSteps);
  } catch (const std::runtime_error& broken) {
    FAIL() << broken.what();
  }
  // A scenario that never gets anywhere proves nothing.
  EXPECT_GT(scenario.obeyed(), kSteps / 100);
  EXPECT_GT(scenario.torques(), kSteps / 100);
  for (const Mode mode : modes) {
    EXPECT_GT(scenario.visits()[static_cast<std::size_t>(mode)], kSteps / 200) << name_of(mode);
  }
}

class OwnerInRandomScenarios : public testing::TestWithParam<std::uint64_t> {};

TEST_P(OwnerInRandomScenarios, IntegratorInRealtime) {
  // A small fall, since every run is short.
  hold<IntegratorScenario, Integrator>(
      {"safety.fall_tilt_rad=0.02"}, GetParam(),
      {Mode::kHeld, Mode::kRunning, Mode::kPaused, Mode::kSafeStop, Mode::kFallen});
}

TEST_P(OwnerInRandomScenarios, IntegratorInLockstep) {
  hold<IntegratorScenario, Integrator>(
      {"loop.clock=lockstep"}, GetParam(),
      {Mode::kHeld, Mode::kRunning, Mode::kPaused, Mode::kSafeStop});
}

TEST_P(OwnerInRandomScenarios, FreeIntegrator) {
  hold<IntegratorScenario, Integrator>(
      {"loop.clock=free"}, GetParam(),
      {Mode::kHeld, Mode::kRunning, Mode::kPaused, Mode::kSafeStop});
}

TEST_P(OwnerInRandomScenarios, Hardware) {
  hold<HardwareScenario, Hardware>({"safety.fall_tilt_rad=0.2"}, GetParam(),
                                   {Mode::kHeld, Mode::kRunning, Mode::kSafeStop, Mode::kFallen});
}

INSTANTIATE_TEST_SUITE_P(Seeds, OwnerInRandomScenarios, testing::Values(1, 2, 20261));

}  // namespace
}  // namespace gyrotwin
