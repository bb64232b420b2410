// The control laws: values, limits, what make_law refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/controller/law.hpp"
#include "services/runtime/error.hpp"
#include "tests/support/law_rigs.hpp"

namespace gyrotwin {
namespace {

using model::Observation;
using reference::brennan;
using reference::constant_speed;
using reference::momentum_manager;
using reference::reduced_lqr;
using reference::tilt_to_speed;

Observation spinning(double disc_rate) {
  Observation seen;
  seen.disc_rate = disc_rate;
  return seen;
}

double torque(const Law& law, const Observation& seen, double z = 0.0) {
  return law.torque(seen, LawState(z, 0.0))[0];
}

/// z' where the drive gives at most `limit` [N m] either way.
double rate(const Law& law, const Observation& seen, double z, double limit = 1e9) {
  const DriveTorques wanted = law.torque(seen, LawState(z, 0.0));
  return law.rates(seen, LawState(z, 0.0), wanted, {std::clamp(wanted[0], -limit, limit)})[0];
}

std::string refusal(const Rig& rig) {
  try {
    make_law(rig);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// ---- constant speed

TEST(ConstantSpeed, IsProportionalPlusIntegral) {
  const auto law = make_law(constant_speed());
  EXPECT_EQ(law->states(), 1);
  EXPECT_DOUBLE_EQ(torque(*law, spinning(-4.0)), -3.0);
  EXPECT_DOUBLE_EQ(torque(*law, spinning(-4.0), 2.0), -1.0);
  EXPECT_DOUBLE_EQ(torque(*law, spinning(-5.0), 99.0), 3.0);
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-4.0), 2.0), -6.0);
}

TEST(ConstantSpeed, IntegralStopsAtItsLimitAndLeavesIt) {
  const auto law = make_law(constant_speed());
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-6.0), 3.0), 0.0);   // outward
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-4.0), 3.0), -6.0);  // inward
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-4.0), -3.0), 0.0);
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-6.0), -3.0), 6.0);
}

TEST(ConstantSpeed, IntegralIsHeldWhereTheDriveIsAtItsLimit) {
  const auto law = make_law(constant_speed());
  EXPECT_DOUBLE_EQ(rate(*law, spinning(0.0), 1.0, 4.0), 0.0);      // wants -14, gets -4
  EXPECT_DOUBLE_EQ(rate(*law, spinning(-10.0), 1.0, 4.0), 0.0);    // wants 16, gets 4
  EXPECT_NEAR(rate(*law, spinning(-4.9), 2.9, 1.0), -0.6, 1e-14);  // wants 2.6, gets 1: unwinds
  EXPECT_DOUBLE_EQ(rate(*law, spinning(0.0), 1.0, 14.0), -30.0);   // gets what it wants
}

// ---- momentum manager

TEST(MomentumManager, AsksForTheMissingMomentumAndTheFriction) {
  const Rig rig = momentum_manager();
  const auto law = make_law(rig);
  const auto platform = model::reduce(std::get<model::UmbrellaParameters>(rig.machine));
  Observation seen = spinning(-5.0);
  EXPECT_NEAR(torque(*law, seen), -0.1 - 0.05, 1e-12);  // at the goal: friction alone
  seen.disc_rate = -2.0;
  seen.gimbal_angle[0] = 0.1;
  const double missing = -platform.C * 3.0 - 4 * 2.1e-3 * 400 * std::numbers::pi * std::sin(0.1);
  EXPECT_NEAR(torque(*law, seen), 5.0 * missing - 0.1 - 0.02, 1e-12);
}

// Contact forces exchange the momentum of disc and gyros, they do not change it: nothing to do.
TEST(MomentumManager, LeavesAnExchangeOfMomentumAlone) {
  Rig rig = momentum_manager();
  auto& p = std::get<model::UmbrellaParameters>(rig.machine);
  p.disc.coulomb_friction = p.disc.viscous_friction = 0.0;
  const auto law = make_law(rig);
  const auto platform = model::reduce(p);
  Observation seen;
  seen.gimbal_angle[0] = 0.02;
  seen.disc_rate = -5.0 - platform.Nh * std::sin(0.02) / platform.C;
  EXPECT_NEAR(torque(*law, seen), 0.0, 1e-14);
}

TEST(MomentumManager, OnADroopedRingRestsAtItsDiscSpeed) {
  Rig rig = momentum_manager();
  rig.machine = reference::umbrella("prototype_b_sleeping");
  Observation seen = spinning(-5.0);
  seen.gimbal_angle[0] = std::get<model::UmbrellaParameters>(rig.machine).gyros.ring_elevation;
  EXPECT_NEAR(torque(*make_law(rig), seen), -0.15, 1e-12);
}

TEST(MomentumManager, ElevationGainAnswersToChangesOnly) {
  Rig rig = momentum_manager();
  const auto plain = make_law(rig);
  rig.controller.elevation_gain = 60.0;
  const auto law = make_law(rig);
  Observation seen = spinning(-5.0);
  seen.gimbal_angle[0] = 0.03;
  const LawState rest = law->start(seen);
  EXPECT_DOUBLE_EQ(rest[0], 0.03);
  EXPECT_DOUBLE_EQ(torque(*law, seen, rest[0]), torque(*plain, seen));
  EXPECT_DOUBLE_EQ(rate(*law, seen, rest[0]), 0.0);
  EXPECT_NEAR(torque(*law, seen, 0.01) - torque(*plain, seen), 60.0 * 0.02, 1e-12);
  EXPECT_NEAR(rate(*law, seen, 0.01), 2.0 * 0.02, 1e-15);
}

// ---- reduced LQR

TEST(ReducedLqr, FeedsTiltMagnitudeItsRateAndDiscSpeedBack) {
  Rig rig = reduced_lqr("prototype_b", 2.0, 0.02, 5.0);
  rig.controller.gain = {100.0, 10.0, 1.0};
  const auto law = make_law(rig);
  Observation seen = spinning(-1.0);
  seen.tilt = {-0.03, 0.04};
  seen.tilt_rate = {-1.0, 2.0};
  const double friction = 0.1 * std::tanh(-1.0 / 0.05);
  EXPECT_NEAR(torque(*law, seen), -(5.0 + 22.0 + 1.0) + friction, 1e-12);
  seen.tilt = {0.0, 0.0};  // no direction, no rate
  EXPECT_NEAR(torque(*law, seen), -1.0 + friction, 1e-12);
}

// ---- precession LQR

/// K = (1, 2, 3, 4) and a state that shows each product in its own digit.
DriveTorques shown(Rig rig, const std::array<double, 4>& gimbals) {
  rig.controller.gain = {1.0, 2.0, 3.0, 4.0};
  rig.controller.tilt_max.reset();  // weights are not needed then
  Observation seen;
  seen.tilt = {1.0, 2.0};
  seen.tilt_rate = {10.0, 20.0};
  seen.gimbal_angle = gimbals;
  for (int i = 0; i < 4; ++i) seen.gimbal_rate[i] = 10.0 * gimbals[i];
  return make_law(rig)->torque(seen, LawState::Zero());
}

TEST(PrecessionLqr, FeedsEachTiltToItsGimbals) {
  const DriveTorques single = shown(reference::gyrocar(), {100.0});
  EXPECT_EQ(single, (DriveTorques{1.0 + 20.0 - 300.0 - 4000.0}));
  const DriveTorques pair = shown(brennan(), {100.0, -100.0});
  EXPECT_EQ(pair, (DriveTorques{-(1.0 + 20.0 + 300.0 + 4000.0)}));
  const DriveTorques pairs = shown(reference::double_brennan(), {100.0, -100.0, 200.0, -200.0});
  EXPECT_EQ(pairs, (DriveTorques{-4321.0, 2.0 + 40.0 - 600.0 - 8000.0}));
}

TEST(PrecessionLqr, DescribesAGivenGainWithItsPoles) {
  Rig rig = brennan();
  rig.controller.gain = {1.0, 2.0, 3.0, 4.0};
  EXPECT_NE(make_law(rig)->describe().find("K = (1, 2, 3, 4), closed-loop poles "),
            std::string::npos);
}

// ---- what make_law refuses

TEST(MakeLaw, RefusesALawThatDoesNotFitAndNamesThoseThatDo) {
  Rig rig = brennan();
  rig.controller.law = LawKind::kMomentumManager;
  EXPECT_EQ(refusal(rig),
            "example.toml: law momentum_manager does not fit a machine with driven gimbals; laws "
            "that fit: none, open_loop, precession, shelf, precession_lqr");
  rig = constant_speed();
  for (const LawKind law : {LawKind::kPrecessionLqr, LawKind::kPrecession, LawKind::kShelf}) {
    rig.controller.law = law;
    EXPECT_EQ(refusal(rig), "example.toml: law " + std::string(name_of(law)) +
                                " does not fit an umbrella platform; laws that fit: none, "
                                "open_loop, constant_speed, tilt_to_speed, momentum_manager, "
                                "reduced_lqr");
  }
  rig.machine = model::GyroscopeParameters{};
  EXPECT_EQ(refusal(rig),
            "example.toml: law shelf does not fit a gyroscope on a post; laws that fit: none, "
            "open_loop, constant_speed");
}

/// The law without one of its numbers.
struct Without {
  Rig rig;
  std::optional<double> Rig::Controller::*number;
  std::string key;
};

TEST(MakeLaw, NamesTheMissingNumber) {
  using C = Rig::Controller;
  const Rig lqr = reduced_lqr("prototype_b", 2.0, 0.02, 5.0);
  const Rig wave = reference::open_loop(constant_speed(), Wave::kSine, 1.0, 1.0);
  const Rig precession = reference::precession("brennan_monorail", 2e5, 1500.0, 8e3);
  const Rig shelf = reference::shelf("brennan_monorail", 6000.0, 0.03, 1500.0, 8e3);
  const Without cases[]{{constant_speed(), &C::disc_speed, "disc_speed_rad_s"},
                        {constant_speed(), &C::kp, "kp_nms_per_rad"},
                        {constant_speed(), &C::ki, "ki_nm_per_rad"},
                        {constant_speed(), &C::integral_limit, "integral_limit_nm"},
                        {tilt_to_speed(), &C::kp, "kp_nms_per_rad"},
                        {tilt_to_speed(), &C::disc_speed, "disc_speed_rad_s"},
                        {tilt_to_speed(), &C::tilt_speed_gain, "tilt_speed_gain_per_s"},
                        {tilt_to_speed(), &C::rate_speed_gain, "rate_speed_gain"},
                        {tilt_to_speed(), &C::speed_limit, "speed_limit_rad_s"},
                        {momentum_manager(), &C::disc_speed, "disc_speed_rad_s"},
                        {momentum_manager(), &C::momentum_rate, "momentum_rate_per_s"},
                        {lqr, &C::disc_speed, "disc_speed_rad_s"},
                        {lqr, &C::tilt_max, "tilt_max_rad"},
                        {lqr, &C::speed_max, "speed_max_rad_s"},
                        {lqr, &C::torque_max, "torque_max_nm"},
                        {wave, &C::amplitude, "amplitude_nm"},
                        {wave, &C::frequency, "frequency_hz"},
                        {precession, &C::tilt_gain, "tilt_gain_nm_per_rad"},
                        {precession, &C::gimbal_damping, "gimbal_damping_nms_per_rad"},
                        {precession, &C::gimbal_gain, "gimbal_gain_nm_per_rad"},
                        {shelf, &C::shelf_torque, "shelf_torque_nm"},
                        {shelf, &C::shelf_tilt, "shelf_tilt_rad"},
                        {shelf, &C::gimbal_damping, "gimbal_damping_nms_per_rad"},
                        {shelf, &C::gimbal_gain, "gimbal_gain_nm_per_rad"},
                        {brennan(), &C::tilt_max, "tilt_max_rad"},
                        {brennan(), &C::gimbal_max, "gimbal_max_rad"},
                        {brennan(), &C::torque_max, "torque_max_nm"}};
  for (const Without& without : cases) {
    Rig rig = without.rig;
    EXPECT_EQ(refusal(rig), "") << name_of(rig.controller.law);
    (rig.controller.*without.number).reset();
    EXPECT_EQ(refusal(rig), "example.toml: law " + std::string(name_of(rig.controller.law)) +
                                " needs `controller." + without.key + '`');
  }
}

TEST(MakeLaw, AGainStandsForTheWeights) {
  Rig rig = brennan();
  rig.controller.tilt_max.reset();
  rig.controller.gimbal_max.reset();
  EXPECT_EQ(refusal(rig),
            "example.toml: law precession_lqr needs `controller.tilt_max_rad`, "
            "`controller.gimbal_max_rad`");
  rig.controller.gain = {1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(refusal(rig), "");
}

TEST(MakeLaw, RefusesAGainOfTheWrongLength) {
  Rig rig = brennan();
  rig.controller.gain = {1.0, 2.0, 3.0};
  EXPECT_NE(refusal(rig).find("has 3 numbers, law precession_lqr takes 4"), std::string::npos);
}

TEST(MakeLaw, NoLawIsNoObject) {
  Rig rig = brennan();
  rig.controller.law = LawKind::kNone;
  EXPECT_EQ(make_law(rig), nullptr);
}

}  // namespace
}  // namespace gyrotwin
