// What simulate says of a run in the end.
#include "clients/simulate/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "clients/common/tilt.hpp"
#include "services/model/gyroscope.hpp"
#include "tests/support/law_rigs.hpp"

namespace gyrotwin {
namespace {

/// Ten seconds in which the first coordinate goes its way [deg].
Verdict watch(const Rig& rig, const model::Machine& machine, int coordinate,
              const std::function<double(double)>& way) {
  Verdict verdict(rig, machine, 10.0);
  for (int k = 0; k <= 1000; ++k) {
    model::State state = machine.state({}, {});
    state.q[coordinate] = radians(way(0.01 * k));
    verdict.note(0.01 * k, machine, state);
  }
  return verdict;
}

std::string told(const std::function<double(double)>& way) {
  const Rig rig = reference::double_brennan();
  return watch(rig, rig.build_machine(), 0, way).text();
}

TEST(Verdict, StandsWhereItsWorstIsOver) {
  EXPECT_EQ(told([](double t) { return 5.0 * std::exp(-t); }),
            "stands: tilt at most 5 deg, 0.000227 deg at the end");
  EXPECT_EQ(told([](double t) { return 5.0 * std::sin(3.0 * t); }),
            "stands: tilt at most 5 deg, 4.94 deg at the end")
      << "a steady swing does not grow";
  EXPECT_EQ(told([](double) { return 0.0; }), "stands: tilt at most 0 deg, 0 deg at the end");
}

TEST(Verdict, StandsSoFarWhereTheTiltStillGrows) {
  EXPECT_EQ(told([](double t) { return 0.1 * std::exp(0.3 * t); }),
            "stands so far: tilt at most 2.01 deg, 2.01 deg at the end, and growing");
  EXPECT_EQ(told([](double t) { return std::exp(0.1 * t) * std::sin(3.0 * t); }).substr(0, 13),
            "stands so far")
      << "its largest swing need not be the last row";
}

TEST(Verdict, FallsWhereTheLimitIsPassed) {
  Rig rig = reference::double_brennan();
  rig.safety.fall_tilt_rad = radians(40.0);
  const Verdict verdict =
      watch(rig, rig.build_machine(), 0, [](double t) { return 10.0 * t + 0.05; });
  EXPECT_EQ(verdict.text(), "falls: tilt beyond 40.0 deg (safety.fall_tilt_rad) at 3.995 s");
  EXPECT_NEAR(*verdict.fell_at(), 3.995, 1e-9);  // measured 2e-15
}

/// A ring joins tilt and gimbals: those in their stops hold what has toppled.
TEST(Verdict, LeansWhereTheStopsHoldIt) {
  const Rig rig = load_rig("prototype_b");
  const model::Machine machine = rig.build_machine();
  const int gimbal = machine.layout.gimbals[0].coordinate;
  const auto said = [&](double tilt, double gimbal_angle) {
    Verdict verdict(rig, machine, 10.0);
    for (int k = 0; k <= 1000; ++k) {
      model::State state = machine.state({}, {});
      state.q[machine.layout.tilt[0]] = radians(std::min(tilt, 0.1 * k));
      state.q[gimbal] = gimbal_angle;
      verdict.note(0.01 * k, machine, state);
    }
    return verdict.text();
  };
  EXPECT_EQ(said(23.0, 0.71), "leans on its gimbal stops at 23 deg: tilt at most 23 deg");
  EXPECT_EQ(said(23.0, 0.69), "stands: tilt at most 23 deg, 23 deg at the end");
  EXPECT_EQ(said(0.5, 0.71), "stands: tilt at most 0.5 deg, 0.5 deg at the end") << "upright";
}

/// Under a load of chance the largest swing may well be the last.
TEST(Verdict, SeesNoGrowthUnderALoadOfChance) {
  const Rig rig = reference::double_brennan();
  const model::Machine machine = rig.build_machine();
  for (const bool random : {false, true}) {
    Verdict verdict(rig, machine, 1.0, random);
    for (int k = 0; k <= 100; ++k) {
      model::State state = machine.state({}, {});
      state.q[0] = 1e-3 * k;
      verdict.note(0.01 * k, machine, state);
    }
    EXPECT_EQ(verdict.growing(), !random);
  }
}

TEST(Verdict, IsAboutTheStopsWhereNothingCanTilt) {
  Rig rig;
  rig.machine = model::GyroscopeParameters{.gyro = {.mass = 1.0,
                                                    .inertia_transverse = 0.01,
                                                    .inertia_axial = 0.01,
                                                    .rotor_inertia = 0.005,
                                                    .rotor_speed = 500.0,
                                                    .cm_distance = 0.1,
                                                    .axle_length = 0.2,
                                                    .stop = radians(60.0),
                                                    .stop_stiffness = 100.0,
                                                    .hinge_damping = 0.01,
                                                    .post_damping = 0.01,
                                                    .post_inertia = 0.01},
                                           .torque_limit = 1.0};
  const model::Machine machine = rig.build_machine();
  const auto said = [&](const std::function<double(double)>& way) {
    return watch(rig, machine, machine.layout.gimbals[0].coordinate, way).text();
  };
  EXPECT_EQ(said([](double t) { return 20.0 * std::exp(-t); }),
            "keeps off its stops: 40 deg away at the closest");
  EXPECT_EQ(said([](double t) { return -4.0 * t; }),
            "keeps off its stops so far: 20 deg away at the closest, and still closing in");
  EXPECT_EQ(said([](double t) { return -8.0 * t; }),
            "meets its stop: a gimbal reaches it at 7.510 s");
}

}  // namespace
}  // namespace gyrotwin
