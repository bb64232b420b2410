// What stands and what falls, close to upright, by the exact Jacobian of the whole machine: the
// statements of services/model/README.md, sections 4 and 5.
#include <gtest/gtest.h>

#include <cmath>

#include "services/model/eigenvalues.hpp"
#include "services/model/free_tilt.hpp"
#include "services/model/linearise.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using Eigen::MatrixXd;
using model::Coordinates;
using model::FreeTilt;
using model::Linearisation;
using model::Machine;
using model::State;
using reference::Random;

constexpr double kDroop = -50.0 * M_PI / 180.0;

/// Largest growth of small deviations [1/s]; the disc's angle is cyclic and its speed held.
double growth(const Machine& machine, const State& state) {
  const Linearisation about = linearise(machine, state, {});
  const int n = machine.coordinates();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = about.dq.topLeftCorner(n, n);
  A.bottomRightCorner(n, n) = about.dv.topLeftCorner(n, n);
  for (const int cyclic : {machine.layout.disc, n + machine.layout.disc}) {
    A.row(cyclic).setZero();
    A.col(cyclic).setZero();
    A(cyclic, cyclic) = -1e3;
  }
  return model::eigenvalues(A).real().maxCoeff();
}

/// A platform whose gyros stay at one elevation, on a bushing and no ring.
model::UmbrellaParameters held_gyros(double elevation, const model::TiltBushing& bushing) {
  auto p = reference::umbrella("prototype_b");
  p.mount = model::Mount::kUniversalJoint;
  p.track = model::TrackKind::kNone;
  p.bushing = bushing;
  p.structure.damping = p.disc.viscous_friction = p.disc.coulomb_friction = 0.0;
  p.gyros.ring_elevation = elevation;
  p.gyros.stop_lower = p.gyros.stop_upper = elevation - 1e-12;  // just in the stop: it is stiff
  p.gyros.stop_stiffness = 1e9;
  p.gyros.damping = 50.0;
  return p;
}

State turning(const Machine& machine, double elevation, double disc_speed) {
  return machine.state({0, 0, 0, 0, 0, elevation}, {0, 0, 0, 0, disc_speed, 0});
}

/// Nothing turns. A spring between structure and disc, of any stiffness, gives the stiffness matrix
/// [[-U + k, -k], [-k, P + k]]: it stands for P > U alone, and then only if the spring is stiff.
TEST(FreeDisc, StandsStillOnlyWhenItHangs) {
  Random random(51);
  int hanging = 0;
  for (int i = 0; i < 200; ++i) {
    const double stiffness = std::pow(10.0, random.between(0.0, 5.0));
    auto p = held_gyros(0.0, {stiffness, 1.0, 1.0});
    p.gyros.rotor_speed = 0.0;
    p.gyros.pivot_height = random.between(-0.6, 0.1);
    const double U = free_tilt(p, 0.0).U, P = free_tilt(p, 0.0).P;
    const bool expected = stiffness * (P - U) - U * P > 0.0 && P + stiffness > 0.0;
    const Machine machine = model::build(p);
    EXPECT_EQ(growth(machine, turning(machine, 0.0, 0.0)) < 1e-9, expected)
        << "k " << stiffness << ", U " << U << ", P " << P;
    hanging += expected ? 1 : 0;
    EXPECT_FALSE(P < U && expected);
  }
  EXPECT_GT(hanging, 20);
  EXPECT_LT(hanging, 180);
}

/// Structure and disc locked together spin as a top: Jt z" - i L z' - (U - P) z = 0, with
/// L = Jz Omega + N h sin tg0, stands for L^2 > 4 Jt (U - P). Nothing damps here, so it neither
/// comes back nor departs; below the limit it grows by the formula's rate.
TEST(FreeDisc, LockedTogetherIsASleepingTop) {
  auto p = held_gyros(kDroop, {1e7, 0.0, 0.0});
  p.gyros.damping = 0.0;
  double worst = 0.0;
  for (const double share : {0.05, 0.2, 0.35, 0.6, 1.0}) {
    p.gyros.rotor_speed = share * 1256.6;
    const Machine machine = model::build(p);
    const FreeTilt x = free_tilt(p, kDroop);
    const double Jt = x.locked_inertia()[0], L = x.momentum(-1.0);
    const double left = 4.0 * Jt * (x.U - x.P) - L * L;
    const double expected = left > 0.0 ? std::sqrt(left) / (2.0 * Jt) : 0.0;
    worst = std::max(worst, std::abs(growth(machine, turning(machine, kDroop, -1.0)) - expected));
  }
  EXPECT_LT(worst, 2e-4);  // [1/s], measured 5.4e-5: the spring that locks gives a little
}

/// Damping that turns with the disc holds it in a window of speeds; on the wrong side of it, or
/// turning the other way, it falls.
TEST(FreeDisc, RotatingDampingHasAWindowOfSpeeds) {
  const model::TiltBushing bushing{100.0, 30.0, 0.0};
  auto p = held_gyros(kDroop, bushing);
  p.structure.damping = 0.02;
  const Machine machine = model::build(p);
  const FreeTilt x = free_tilt(p, kDroop);
  double worst = 0.0;
  for (const auto& [speed, stands] : {std::pair{-2.0, false},
                                      {-3.0, false},
                                      {-4.0, true},
                                      {-5.0, true},
                                      {-6.0, true},
                                      {-8.0, false},
                                      {5.0, false}}) {
    const double found = growth(machine, turning(machine, kDroop, speed));
    EXPECT_EQ(found < 0.0, stands) << speed << " rad/s: " << found << " 1/s";
    worst = std::max(worst, std::abs(found - tilt_growth(x, p.mount, bushing, 0.02, speed)));
  }
  EXPECT_LT(worst, 1e-4);  // [1/s], measured 4.7e-6
}

/// In every mount, roll and pitch unequal, with dampers of every kind: the tilt equations are the
/// machine's.
TEST(FreeDisc, TiltsAsItsTwoBodies) {
  Random random(53);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double elevation = random.between(-1.0, 1.0);
    const model::TiltBushing bushing{random.between(10, 300), random.between(0, 30),
                                     random.between(0, 30)};
    auto p = held_gyros(elevation, bushing);
    p.mount = std::array{model::Mount::kLevel, model::Mount::kUniversalJoint,
                         model::Mount::kRigid}[static_cast<std::size_t>(i % 3)];
    p.structure.inertia_y = random.between(0.1, 0.4);
    p.structure.damping = random.between(0.0, 0.5);
    p.gyros.rotor_speed = random.between(-1500, 1500);
    p.gyros.cm_distance = random.between(-0.03, 0.03);
    const double speed = random.between(-8, 8);
    const Machine machine = model::build(p);
    State state = machine.state({}, {});
    const int tg = machine.layout.gimbals[0].coordinate;
    state.q[tg] = elevation;
    state.v[machine.layout.disc] = speed;
    const Linearisation pressed = linearise(machine, state, {});
    state.q[tg] -= pressed.acceleration[tg] / pressed.dq(tg, tg);  // as far as the stop gives
    const double expected =
        tilt_growth(free_tilt(p, elevation), p.mount, bushing, p.structure.damping, speed);
    worst = std::max(worst, std::abs(growth(machine, state) - expected));
  }
  EXPECT_LT(worst, 1e-4);
}

/// Friction at the ground takes energy from the slow precession, whose energy is negative: a
/// sleeping top spirals out, by c0 w_slow/(|L| - 2 Jt w_slow).
TEST(FreeDisc, GroundFrictionMakesATopSpiralOut) {
  auto p = held_gyros(kDroop, {1e7, 0.0, 0.0});
  p.gyros.damping = 0.0;
  double worst = 0.0;
  for (const double c0 : {0.002, 0.02, 0.1}) {
    p.structure.damping = c0;
    const Machine machine = model::build(p);
    const FreeTilt x = free_tilt(p, kDroop);
    const double Jt = x.locked_inertia()[0], L = std::abs(x.momentum(-5.0));
    const double slow = precession(x, -5.0)->slow;
    const double expected = c0 * slow / (L - 2.0 * Jt * slow);
    worst =
        std::max(worst, std::abs(growth(machine, turning(machine, kDroop, -5.0)) / expected - 1.0));
  }
  EXPECT_LT(worst, 3e-3);  // measured 3.1e-4, of second order in c0
}

/// Gimbals driven by u = -kth th - cq q' + kappa q: it stands for kth J/H < cq < kth H/U, and the
/// precession must be pushed on, kappa > 0.
TEST(Gimballed, StandsWithinTheWindowOfItsGimbalDamping) {
  Random random(52);
  int inside = 0;
  for (int i = 0; i < 400; ++i) {
    auto p = random.gimballed(model::Arrangement::kPair);
    p.gyros.rotor_speed = random.between(50, 600);
    p.structure.damping = p.gyros.damping = 0.0;
    const auto r = model::reduce(p);
    if (r.H * r.H < 2.0 * r.J * r.U) continue;
    const double kth = random.between(10, 100);
    const double low = kth * r.J / r.H, high = kth * r.H / r.U;
    const double cq = low * std::pow(high / low, random.between(-0.5, 1.5));
    if (std::abs(cq / low - 1.0) < 0.05 || std::abs(cq / high - 1.0) < 0.05) continue;
    const double kappa = (i % 5 == 0 ? -1e-4 : 1e-4) * r.H * r.H / r.A;
    const Machine machine = model::build(p);
    const Linearisation about = linearise(machine, machine.state({}, {}), {});
    const Eigen::Matrix2d B = about.torque.topLeftCorner<2, 1>() * Eigen::RowVector2d(1, 0);
    Eigen::Matrix4d F = Eigen::Matrix4d::Zero();
    F.topRightCorner<2, 2>().setIdentity();
    F.bottomLeftCorner<2, 2>() = about.dq.topLeftCorner<2, 2>() - kth * B;
    F.bottomLeftCorner<2, 2>().col(1) += kappa * about.torque.topLeftCorner<2, 1>();
    F.bottomRightCorner<2, 2>() = about.dv.topLeftCorner<2, 2>();
    F.bottomRightCorner<2, 2>().col(1) -= cq * about.torque.topLeftCorner<2, 1>();
    const bool expected = cq > low && cq < high && kappa > 0.0;
    EXPECT_EQ(model::eigenvalues(F).real().maxCoeff() < 0.0, expected)
        << "cq " << cq << " in " << low << " to " << high << ", kappa " << kappa;
    inside += expected ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
}

}  // namespace
}  // namespace gyrotwin
