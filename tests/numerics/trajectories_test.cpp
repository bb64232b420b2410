// Motions of all machines, in and out of contact and under feedback, against the series of an
// independent code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/reference_data.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using model::Input;
using model::Machine;
using model::Mount;
using model::State;
using model::TrackKind;

Machine umbrella(const std::string& set, Mount mount, TrackKind track) {
  auto p = reference::umbrella(set);
  p.mount = mount;
  p.track = track;
  return model::build(p);
}

Machine gimballed(const std::string& set) { return model::build(reference::gimballed(set)); }

/// Largest difference at any sample, over what is allowed: 100 times the series' own uncertainty.
/// Measured 0.005 at most.
template <typename Law>
double worst_of(const Machine& machine, const std::string& name, const Law& feedback) {
  const reference::Trajectory series = reference::trajectory(name);
  const double allowed = std::max(100.0 * series.uncertainty, 1e-7);
  const auto law = [&](double t, const State& state) {
    Input input = feedback(t, state);
    input.mode = model::DriveMode::kIdealTorque;
    return input;
  };
  State state = machine.state(series.samples[0].q, series.samples[0].v);
  double worst = 0.0;
  for (std::size_t i = 1; i < series.samples.size(); ++i) {
    const auto& sample = series.samples[i];
    const double before = series.samples[i - 1].t;
    const auto shifted = [&](double t, const State& s) { return law(before + t, s); };
    state = reference::simulate(machine, state, sample.t - before, shifted, {1e-12, 1e-13});
    const State expected = machine.state(sample.q, sample.v);
    worst = std::max({worst, (state.q - expected.q).cwiseAbs().maxCoeff(),
                      (state.v - expected.v).cwiseAbs().maxCoeff()});
  }
  return worst / allowed;
}

TEST(Trajectories, LevelUmbrella) {
  const auto free = [](double, const State&) { return Input{}; };
  EXPECT_LT(worst_of(umbrella("prototype_b", Mount::kLevel, TrackKind::kNone),
                     "prototype_b_level_free", free),
            1.0);
  EXPECT_LT(worst_of(umbrella("prototype_b", Mount::kLevel, TrackKind::kLower),
                     "prototype_b_level_lower", free),
            1.0);
  EXPECT_LT(
      worst_of(umbrella("gooch", Mount::kLevel, TrackKind::kLower), "gooch_level_lower", free),
      1.0);
  EXPECT_LT(
      worst_of(umbrella("townsend", Mount::kLevel, TrackKind::kNone), "townsend_level_free", free),
      1.0);
}

TEST(Trajectories, FallingUmbrella) {
  const auto free = [](double, const State&) { return Input{}; };
  EXPECT_LT(worst_of(umbrella("prototype_b", Mount::kUniversalJoint, TrackKind::kLower),
                     "prototype_b_universal_lower_falls", free),
            1.0);
  EXPECT_LT(worst_of(umbrella("prototype_b", Mount::kRigid, TrackKind::kLower),
                     "prototype_b_rigid_lower_falls", free),
            1.0);
}

TEST(Trajectories, SleepingUmbrella) {
  const auto constant_speed = [](double, const State& s) {
    Input input;
    input.drive[0] = 2.0 * (-5.0 - s.v[4]);
    return input;
  };
  EXPECT_LT(worst_of(umbrella("prototype_b_sleeping", Mount::kUniversalJoint, TrackKind::kLower),
                     "prototype_b_sleeping", constant_speed),
            1.0);
}

TEST(Trajectories, Monorail) {
  const auto lqr = [](double, const State& s) {
    Input input;
    input.drive[0] = -(697927 * s.q[0] + 258227 * s.v[0] - 66667 * s.q[1] + 3779 * s.v[1]);
    return input;
  };
  EXPECT_LT(worst_of(gimballed("brennan_monorail"), "brennan_lqr", lqr), 1.0);
}

TEST(Trajectories, GyroCar) {
  const auto lqr = [](double, const State& s) {
    Input input;
    input.drive[0] = 21744 * s.q[0] + 732.3 * s.v[0] + 6000 * s.q[1] - 86.38 * s.v[1];
    return input;
  };
  EXPECT_LT(worst_of(gimballed("gyrocar"), "gyrocar_lqr", lqr), 1.0);
}

TEST(Trajectories, DoubleBrennan) {
  const auto lqr = [](double, const State& s) {
    Input input;
    input.drive[0] = -(72.24 * s.q[0] + 1.726 * s.v[0] - 20 * s.q[2] + .2062 * s.v[2]);
    input.drive[1] = 72.24 * s.q[1] + 1.726 * s.v[1] + 20 * s.q[3] - .2062 * s.v[3];
    return input;
  };
  const auto pushed = [&lqr](double t, const State& s) {
    Input input = lqr(t, s);
    if (t < 0.2) input.moment = {2.0, -1.0, 0.0};
    return input;
  };
  EXPECT_LT(worst_of(gimballed("double_brennan"), "double_brennan_lqr", lqr), 1.0);
  EXPECT_LT(worst_of(gimballed("double_brennan"), "double_brennan_push", pushed), 1.0);
}

}  // namespace
}  // namespace gyrotwin
