// Axle tips on the ring, and the gimbal stops: the force laws, their energies and where they act.
#include "services/model/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/closed_forms.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;
using model::Coordinates;
using model::Machine;
using model::Motion;
using model::Mount;
using model::PerGyro;
using model::State;
using model::Track;
using model::TrackKind;
using reference::Random;

constexpr Mount kMounts[] = {Mount::kLevel, Mount::kRigid, Mount::kUniversalJoint};

Motion motion_of(const Machine& machine, const State& state) {
  Motion motion;
  machine.tree.evaluate(state.q, state.v, {state.rotor_speed}, {Vector3d(0, 0, machine.gravity)},
                        motion);
  return motion;
}

model::TipsOf<double> tips_of(const Machine& machine, const State& state) {
  const Motion motion = motion_of(machine, state);
  return model::tips_of(machine, model::disc_motion(machine, motion), motion, state);
}

/// An axle tip in the structure's frame, by the drawing alone.
Vector3d tip_in_structure(const Machine& machine, const State& state, int gyro) {
  const Motion motion = motion_of(machine, state);
  const model::Gyro& g = machine.tree.gimbals()[0].gyros()[static_cast<std::size_t>(gyro)];
  const double tg = state.q[machine.layout.disc + 1];
  const Vector3d on_disc =
      g.pivot + machine.track->tip * (std::cos(tg) * g.axis + std::sin(tg) * g.raised);
  const Vector3d joint = machine.tree.bodies()[1].pivot;
  return joint + motion.frame[0].R.transpose() * (motion.frame[1].R * on_disc);
}

/// Fourth-order slope of f at 0.
template <typename F>
auto slope(const F& f) {
  const double h = 1e-3;
  using Value = decltype(f(h));
  return Value((8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12.0 * h));
}

model::IndentationOf<double> one_tip(double depth, double rate) {
  model::IndentationOf<double> in{PerGyro<double>::Constant(-1.0), PerGyro<double>::Zero()};
  in.depth[0] = depth;
  in.rate[0] = rate;
  return in;
}

double normal_force(const Track& track, double depth, double rate) {
  return model::normal_force(track, one_tip(depth, rate))[0];
}

TEST(ForceLaw, IsHuntCrossley) {
  Track track{};
  track.stiffness = 1e7;
  track.damping = 0.5;
  EXPECT_DOUBLE_EQ(normal_force(track, 4e-4, 0.0), 80.0);
  EXPECT_DOUBLE_EQ(normal_force(track, 4e-4, 0.4), 96.0);
  EXPECT_DOUBLE_EQ(normal_force(track, 4e-4, -0.4), 64.0);
  EXPECT_EQ(normal_force(track, 4e-4, -3.0), 0.0);  // it never pulls
  EXPECT_EQ(normal_force(track, 0.0, 1.0), 0.0);
  EXPECT_EQ(normal_force(track, -1e-3, 1.0), 0.0);
  EXPECT_EQ(model::contact_energy(track, one_tip(-1e-3, 1.0)), 0.0);
}

TEST(ForceLaw, EnergyIsThatOfTheSpring) {
  Track track{};
  track.stiffness = 1e7;
  for (double depth : {1e-5, 1e-4, 1e-3}) {
    const double force = slope([&](double x) {
                           return model::contact_energy(track, one_tip(depth * (1.0 + x), 0.0));
                         }) /
                         depth;
    EXPECT_NEAR(force / normal_force(track, depth, 0.0), 1.0, 1e-11);  // measured 1.8e-13
  }
}

TEST(ForceLaw, DampingOnlyTakesEnergy) {
  Random random(1);
  Track track{};
  track.stiffness = 1e7;
  track.damping = 2.0;
  for (int i = 0; i < 1000; ++i) {
    const double depth = random.between(0, 1e-3), rate = random.between(-2, 2);
    const double beyond_spring = normal_force(track, depth, rate) - normal_force(track, depth, 0.0);
    EXPECT_GE(beyond_spring * rate, 0.0);
  }
}

TEST(Tip, StartsWhereTheDrawingHasIt) {
  auto p = reference::umbrella("gooch");
  const Machine machine = model::build(p);
  const double phi = 0.3, tg = 0.2;
  const State state = machine.state({0, 0, phi, tg}, {});
  const Motion motion = motion_of(machine, state);
  const auto tips = tips_of(machine, state);
  for (int j = 0; j < 3; ++j) {
    const double azimuth = phi + 2.0 * std::numbers::pi * j / 3.0;
    const double radius = p.gyros.pivot_radius + p.gyros.axle_length * std::cos(tg);
    const Vector3d expected(
        radius * std::cos(azimuth), radius * std::sin(azimuth),
        p.disc.joint_height + p.gyros.pivot_height + p.gyros.axle_length * std::sin(tg));
    const Vector3d found =
        machine.tree.bodies()[1].pivot + motion.frame[1].R * tips.arm.row(j).matrix().transpose();
    EXPECT_LT((found - expected).norm(), 1e-15);  // [m], measured 5.6e-17
  }
}

/// Velocity against the structure and rate of indentation are the derivatives of position and
/// depth.
TEST(Tip, VelocitiesAreDerivatives) {
  Random random(2);
  double worst_v = 0.0, worst_rate = 0.0;
  for (const Mount mount : kMounts) {
    for (int i = 0; i < 100; ++i) {
      auto p = random.umbrella();
      p.mount = mount;
      p.track = TrackKind::kSlot;
      const Machine machine = model::build(p);
      const State state = random.state(machine, 0.7, 3.0);
      const auto at = [&](double t) {
        return State{state.q + t * state.v, state.v, state.rotor_speed};
      };
      const Motion motion = motion_of(machine, state);
      const auto tips = tips_of(machine, state);
      for (int j = 0; j < machine.rotors; ++j) {
        const Vector3d v = motion.frame[0].R *
                           slope([&](double t) { return tip_in_structure(machine, at(t), j); });
        const Vector3d found = motion.frame[1].R * tips.v_rel.row(j).matrix().transpose();
        worst_v = std::max(worst_v, (v - found).norm());
        const double sinking =
            slope([&](double t) { return -tip_in_structure(machine, at(t), j).z(); });
        worst_rate = std::max({worst_rate, std::abs(tips.lower.rate[j] - sinking),
                               std::abs(tips.upper.rate[j] + sinking)});
        EXPECT_NEAR(tips.lower.depth[j] + tips.upper.depth[j], -p.contact.slot_clearance,
                    1e-15);  // measured 3.8e-17
      }
    }
  }
  EXPECT_LT(worst_v, 1e-8);     // [m/s], measured 4.8e-10, of the differences
  EXPECT_LT(worst_rate, 1e-8);  // [m/s], measured 4.7e-10
}

/// The ring's share of the generalised forces, M q'' with and without it, against virtual work: the
/// normal force along the gradient of the tip's height over the track, the drag along v_t.
TEST(Contact, ForcesDoVirtualWork) {
  Random random(3);
  double worst = 0.0;
  for (const Mount mount : kMounts) {
    for (int i = 0; i < 100; ++i) {
      auto p = random.umbrella();
      p.mount = mount;
      p.track = TrackKind::kSlot;
      const Machine machine = model::build(p);
      Machine without = machine;
      without.track.reset();
      const State state = random.state(machine, 0.3, 2.0);
      const Motion motion = motion_of(machine, state);
      const int n = machine.coordinates();
      const Eigen::MatrixXd M = motion.M.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
      Coordinates found = Coordinates::Zero();
      found.head(n) =
          M * (machine.acceleration(state, {}) - without.acceleration(state, {})).head(n);

      const model::Truth truth = machine.truth(state, {});
      Coordinates expected = Coordinates::Zero();
      for (int j = 0; j < machine.rotors; ++j) {
        const double up = truth.contact_lower[j] - truth.contact_upper[j];
        const auto along = [&](int k) {
          return slope([&](double x) {
            const Coordinates q = state.q + x * Coordinates::Unit(k);
            return tip_in_structure(machine, {q, state.v, state.rotor_speed}, j);
          });
        };
        Vector3d v_t = slope([&](double t) {
          const Coordinates q = state.q + t * state.v;
          return tip_in_structure(machine, {q, state.v, state.rotor_speed}, j);
        });
        v_t.z() = 0.0;
        const Vector3d drag =
            -p.contact.rolling_drag * std::abs(up) * v_t / std::sqrt(v_t.squaredNorm() + 1e-4);
        for (int k = 0; k < machine.coordinates(); ++k) {
          expected[k] += along(k).dot(drag + up * Vector3d::UnitZ());
        }
      }
      worst = std::max(worst, (found - expected).norm() / std::max(1.0, expected.norm()));
    }
  }
  EXPECT_LT(worst, 1e-10);  // measured 5.3e-12, of the differences
}

/// In a slot, a tip as far into the upper track as another is into the lower one is pushed as much,
/// the other way.
TEST(Contact, SlotIsSymmetric) {
  auto p = reference::umbrella("prototype_b");
  p.track = TrackKind::kSlot;
  const Machine machine = model::build(p);
  const double into = 5e-4, l = p.gyros.axle_length;
  const auto with_tips_at = [&](double height, double rate) {
    const double tg = std::asin(height / l);
    return machine.truth(machine.state({0, 0, 0.3, tg}, {0, 0, -5, rate / (l * std::cos(tg))}), {});
  };
  const model::Truth low = with_tips_at(-into, -0.1);
  const model::Truth high = with_tips_at(p.contact.slot_clearance + into, 0.1);
  for (int j = 0; j < 4; ++j) {
    EXPECT_NEAR(low.contact_lower[j], p.contact.stiffness * std::pow(into, 1.5) * 1.1,
                1e-11);                                               // measured 1.7e-13
    EXPECT_NEAR(high.contact_upper[j], low.contact_lower[j], 1e-11);  // measured 0
    EXPECT_EQ(low.contact_upper[j], 0.0);
    EXPECT_EQ(high.contact_lower[j], 0.0);
  }
}

/// Around both ends of a gimbal's way, moving in, out and not at all.
TEST(Stop, SpringAndOneSidedDamping) {
  const auto p = reference::gimballed("gyrocar");
  const Machine machine = model::build(p);
  const auto& y = p.gyros;
  double worst = 0.0;
  for (double end : {-y.stop, y.stop}) {
    for (double past = -0.03; past < 0.03; past += 0.0007) {
      for (double v : {-2.0, 0.0, 2.0}) {
        const double q = end + past;
        const Coordinates a = machine.acceleration(machine.state({0, q}, {0, v}), {});
        const double expected =
            reference::stop_torque(-y.stop, y.stop, y.stop_stiffness, q, v) - y.damping * v;
        worst = std::max(worst, std::abs(y.inertia_transverse * a[1] - expected) /
                                    std::max(1.0, std::abs(expected)));
      }
    }
  }
  EXPECT_LT(worst, 1e-14);  // measured 3.6e-16
  EXPECT_EQ(machine.truth(machine.state({0, 0.9 * y.stop}, {}), {}).gimbal_margin,
            y.stop - 0.9 * y.stop);
}

}  // namespace
}  // namespace gyrotwin
