// Precession and shelf: values, the window of the damping, and the monorail that they hold.
#include <gtest/gtest.h>

#include <cmath>

#include "services/controller/precession.hpp"
#include "services/controller/shelf.hpp"
#include "tests/support/law_rigs.hpp"
#include "tests/support/sampled_loop.hpp"

namespace gyrotwin {
namespace {

using model::Observation;
using support::kDegree;
using support::SampledLoop;

/// A state that shows each term of the law in its own digits.
Observation shown(const std::array<double, 4>& gimbals) {
  Observation seen;
  seen.tilt = {1.0, 2.0};
  seen.tilt_rate = {5e6, 7e6};  // which the classical law leaves alone
  seen.gimbal_angle = gimbals;
  for (int i = 0; i < 4; ++i) seen.gimbal_rate[i] = 10.0 * gimbals[i];
  return seen;
}

DriveTorques torques(const Rig& rig, const std::array<double, 4>& gimbals) {
  return make_law(rig)->torque(shown(gimbals), LawState::Zero());
}

TEST(Precession, FeedsEachTiltToItsGimbals) {
  const auto rig = [](const char* set) { return reference::precession(set, 1.0, 4.0, 3.0); };
  // kth th, cq q', kap q; the single gyro and the pitch pair push the other way.
  EXPECT_EQ(torques(rig("brennan_monorail"), {100.0, -100.0}),
            (DriveTorques{-1.0 - 4000.0 + 300.0}));
  EXPECT_EQ(torques(rig("gyrocar"), {100.0}), (DriveTorques{1.0 - 4000.0 + 300.0}));
  EXPECT_EQ(torques(rig("double_brennan"), {100.0, -100.0, 200.0, -200.0}),
            (DriveTorques{-1.0 - 4000.0 + 300.0, 2.0 - 8000.0 + 600.0}));
}

TEST(Shelf, IsTheClassicalLawWithAFrictionThatSlips) {
  const auto rig = [](const char* set) { return reference::shelf(set, 7.0, 0.5, 4.0, 3.0); };
  const double one = 7.0 * std::tanh(2.0), two = 7.0 * std::tanh(4.0);
  EXPECT_EQ(torques(rig("brennan_monorail"), {100.0, -100.0}),
            (DriveTorques{-one - 4000.0 + 300.0}));
  EXPECT_EQ(torques(rig("gyrocar"), {100.0}), (DriveTorques{one - 4000.0 + 300.0}));
  EXPECT_EQ(torques(rig("double_brennan"), {100.0, -100.0, 200.0, -200.0}),
            (DriveTorques{-one - 4000.0 + 300.0, two - 8000.0 + 600.0}));
}

TEST(Shelf, NearUprightHasTheGainsOfTheClassicalLaw) {
  const Shelf shelf(reference::shelf("brennan_monorail", 6000.0, 0.03, 1500.0, 8e3));
  const Precession classical(reference::precession("brennan_monorail", 2e5, 1500.0, 8e3));
  EXPECT_LT((shelf.feedback().poles - classical.feedback().poles).norm(), 1e-9);
  EXPECT_NE(shelf.describe().find("poles -6.1, -3.079+-10.26i, -0.4139 1/s"), std::string::npos);
}

/// Largest real part of the monorail's closed loop [1/s].
double slowest(double gimbal_damping) {
  const Precession law(reference::precession("brennan_monorail", 2e5, gimbal_damping, 8e3));
  return law.feedback().poles.real().maxCoeff();
}

// kth J / H < cq < kth H / U, 430 to 22590 N m s/rad; the machine's own 20 come on top.
TEST(Precession, HoldsWithinTheWindowOfItsDampingAndNotBeyond) {
  EXPECT_NEAR(slowest(1500.0), -0.4139, 1e-3);
  EXPECT_NEAR(slowest(170.0), 1.5950, 1e-3);    // too little: nutation is pumped
  EXPECT_NEAR(slowest(29000.0), 0.5054, 1e-3);  // too much: the precession lags
}

// The drive's limit keeps the nutation from growing for ever.
TEST(Precession, WithoutEnoughDampingTheMonorailKeepsSwinging) {
  Rig rig = reference::precession("brennan_monorail", 2e5, 170.0, 8e3);
  rig.loop.rate_hz = 500.0;
  SampledLoop loop(rig, {1.0 * kDegree});
  loop.run(20.0);
  EXPECT_GT(loop.run(40.0), 3.0);  // measured 3.43
}

struct Machine {
  const char* set;
  double tilt_gain, damping, spring;  // of the precession
  double shelf_torque;                // at 0.03 rad
};

// Numbers of the rig files.
constexpr Machine kMachines[]{{"brennan_monorail", 2e5, 1500.0, 8e3, 6000.0},
                              {"gyrocar", 2e4, 500.0, 6e3, 600.0},
                              {"double_brennan", 60.0, 1.0, 20.0, 1.8}};

class BothLaws : public testing::TestWithParam<Machine> {};

TEST_P(BothLaws, BringTheMachineUpright) {
  const Machine& m = GetParam();
  for (Rig rig : {reference::precession(m.set, m.tilt_gain, m.damping, m.spring),
                  reference::shelf(m.set, m.shelf_torque, 0.03, m.damping, m.spring)}) {
    rig.loop.rate_hz = 500.0;
    SampledLoop loop(rig, {1.0 * kDegree});
    EXPECT_LT(loop.run(20.0), 1.001);
    EXPECT_LT(loop.tilt_deg(), 1e-4);  // measured at most 2.8e-5
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, BothLaws, testing::ValuesIn(kMachines),
                         [](const auto& machine) { return std::string(machine.param.set); });

// A constant moment is met by leaning into it: th = -M / U, and the shelf holds the precession.
TEST(Shelf, LeansIntoTenKilonewtonmetres) {
  Rig rig = reference::shelf("brennan_monorail", 6000.0, 0.03, 1500.0, 8e3);
  rig.loop.rate_hz = 500.0;
  SampledLoop loop(rig);
  loop.run(60.0, [](double) { return Eigen::Vector3d(1e4, 0.0, 0.0); });
  EXPECT_NEAR(loop.state.q[0] / kDegree, -1.160, 1e-3);
  EXPECT_NEAR(loop.state.q[1] / kDegree, -25.28, 0.01);
}

}  // namespace
}  // namespace gyrotwin
