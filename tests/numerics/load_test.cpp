// What a machine carries and what holds it: added masses and the load cell (services/model/
// README.md, section 3).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/model/evaluate.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/simulate.hpp"

namespace gyrotwin {
namespace {

using Eigen::Vector3d;
using model::Arrangement;
using model::Body;
using model::Coordinates;
using model::Input;
using model::Machine;
using model::Mount;
using model::PointMass;
using model::Shape;
using model::State;
using model::Tree;
using reference::Random;

constexpr Shape with_body(Shape shape) {
  return shape.hang(0, 0, {}).pivot_along(model::kAnywhere);
}

/// The tree with the mass built in, as a body of its own on the structure.
template <Shape shape>
Tree with_body(const Tree& tree, const PointMass& added) {
  std::vector<Body> bodies = tree.bodies();
  Body body;
  body.pivot = added.position;
  body.mass = added.mass;
  bodies.push_back(body);
  return model::make_tree<with_body(shape)>(bodies, tree.gimbals());
}

template <Shape shape>
Machine with_body(const Machine& machine, const PointMass& added) {
  Machine loaded = machine;
  loaded.tree = with_body<shape>(machine.tree, added);
  if (machine.unheld) {
    loaded.unheld = with_body<shape_of(Mount::kUniversalJoint)>(*machine.unheld, added);
  }
  return loaded;
}

struct Loadable {
  Machine machine;
  Machine (*with_body)(const Machine&, const PointMass&);
};

std::vector<Loadable> loadable_machines(Random& random) {
  std::vector<Loadable> all;
  auto p = random.umbrella();
  p.mount = Mount::kLevel;
  all.push_back({model::build(p), with_body<shape_of(Mount::kLevel)>});
  p = random.umbrella();
  p.mount = Mount::kRigid;
  all.push_back({model::build(p), with_body<shape_of(Mount::kRigid)>});
  p = random.umbrella();
  p.mount = Mount::kUniversalJoint;
  all.push_back({model::build(p), with_body<shape_of(Mount::kUniversalJoint)>});
  all.push_back({model::build(random.gimballed(Arrangement::kTwoPairs)),
                 with_body<shape_of(Arrangement::kTwoPairs)>});
  all.push_back({model::build(random.gyroscope()), with_body<model::kGyroscopeShape>});
  return all;
}

TEST(AddedMass, IsABodyOfTheStructure) {
  Random random(1);
  double worst_a = 0.0, worst_energy = 0.0, worst_moment = 0.0;
  for (int i = 0; i < 300; ++i) {
    for (const auto& [machine, with_the_body] : loadable_machines(random)) {
      Input built_in = random.input();
      built_in.added = {};
      Input carried = built_in;
      carried.added.add({random.between(0.1, 2), random.vector(0.5)});
      const Machine loaded = with_the_body(machine, carried.added[0]);

      const State state = random.state(machine, 0.3, 2.0);
      const Coordinates expected = loaded.acceleration(state, built_in);
      ASSERT_TRUE(expected.allFinite());
      worst_a = std::max(worst_a,
                         (machine.acceleration(state, carried) - expected).cwiseAbs().maxCoeff() /
                             expected.cwiseAbs().maxCoeff());
      const model::Truth a = machine.truth(state, carried), b = loaded.truth(state, built_in);
      worst_energy = std::max({worst_energy, std::abs(a.kinetic_energy / b.kinetic_energy - 1.0),
                               std::abs(a.potential_energy / b.potential_energy - 1.0)});
      worst_moment = std::max(worst_moment, (a.angular_momentum - b.angular_momentum).norm() /
                                                b.angular_momentum.norm());
      for (int k = 0; k < 2; ++k) {
        const double scale = 1.0 + std::abs(b.holding_moment[0]) + std::abs(b.holding_moment[1]);
        worst_moment =
            std::max(worst_moment, std::abs(a.holding_moment[k] - b.holding_moment[k]) / scale);
      }
    }
  }
  EXPECT_LT(worst_a, 1e-12);       // measured 0: they are the same sums
  EXPECT_LT(worst_energy, 1e-12);  // measured 0
  EXPECT_LT(worst_moment, 1e-12);  // measured 0
}

/// Four masses are one at their centre, as far as weight goes.
TEST(AddedMass, AllFourCount) {
  const Machine machine = model::build(reference::gimballed("double_brennan"));
  Input four;
  four.added = {
      {{0.1, {0.1, 0, 0.2}}, {0.2, {0, 0.1, 0.2}}, {0.3, {-0.1, 0, 0.2}}, {0.4, {0, -0.1, 0.2}}}};
  const State upright = machine.state({}, {});
  const auto V = [&](const State& state) { return machine.truth(state, four).potential_energy; };
  EXPECT_NEAR(V(upright) - machine.truth(upright, {}).potential_energy, 1.0 * model::kGravity * 0.2,
              1e-12);  // measured 4.4e-16
  // Their moments: roll -0.02 m kg, pitch 0.02 m kg, towards where the mass is.
  const double h = 1e-4;
  EXPECT_NEAR((V(machine.state({h, 0}, {})) - V(machine.state({-h, 0}, {}))) / (2 * h),
              model::kGravity * -0.02, 1e-6);  // measured 3.3e-10, of the differences
  EXPECT_NEAR((V(machine.state({0, h}, {})) - V(machine.state({0, -h}, {}))) / (2 * h),
              model::kGravity * 0.02, 1e-6);  // measured 3.2e-10
  const Coordinates a = machine.acceleration(upright, four);
  EXPECT_GT(a[0], 0.0);
  EXPECT_LT(a[1], 0.0);
}

/// prototype_b held at the height of its disc by a cell that feels where the top goes to +y.
Machine held() {
  auto p = reference::frictionless(reference::umbrella("prototype_b"));
  p.track = model::TrackKind::kNone;
  Machine machine = model::build(p);
  machine.load_cell = {{0.0, 0.0, 0.2}, {0.0, 1.0, 0.0}, 1e6, 0.0};
  return machine;
}

/// At rest at thx the cell carries what moment and weight exert: N z cos thx = -(M + U sin thx),
/// N = -k z sin thx.
TEST(LoadCell, CarriesTheMoment) {
  const Machine machine = held();
  const double U = model::reduce(reference::umbrella("prototype_b")).U;
  const double k = machine.load_cell->stiffness, z = machine.load_cell->point.z();
  for (const double thx : {-1e-3, 1e-5, 2e-3}) {
    const double force = -k * z * std::sin(thx);
    Input input;
    input.moment.x() = -U * std::sin(thx) - force * z * std::cos(thx);
    const State state = machine.state({thx}, {});
    EXPECT_NEAR(machine.truth(state, input).load_cell, force, 1e-9);  // [N], measured 5.7e-14
    EXPECT_NEAR(machine.acceleration(state, input)[0], 0.0, 1e-9);    // [rad/s^2], measured 3e-14
    EXPECT_NEAR(machine.truth(state, {}).potential_energy -
                    machine.truth(machine.state({}, {}), {}).potential_energy,
                U * (std::cos(thx) - 1.0) + 0.5 * force * force / k,
                1e-12);  // measured 3.6e-15  // [J]
  }
  EXPECT_EQ(machine.truth(machine.state({}, {}), {}).load_cell, 0.0);
}

/// The held structure rings at sqrt((k z^2 - U) / a).
TEST(LoadCell, RingsAtItsFrequency) {
  const auto p = reference::umbrella("prototype_b");
  const Machine machine = held();
  const double U = model::reduce(p).U, z = machine.load_cell->point.z();
  const double a = p.structure.inertia_x +
                   (p.disc.mass + p.gyros.count * p.gyros.mass) * std::pow(p.disc.joint_height, 2);
  const double frequency = std::sqrt((machine.load_cell->stiffness * z * z - U) / a);
  const double amplitude = 1e-5, t = 0.3;  // [rad], [s]
  const State end =
      reference::simulate(machine, machine.state({amplitude}, {}), t, reference::no_input);
  EXPECT_GT(frequency * t, 80.0);                                    // [rad]: thirteen periods
  EXPECT_NEAR(end.q[0] / amplitude, std::cos(frequency * t), 1e-6);  // measured 5.4e-9
}

/// A damped cell settles under a moment, and shows it.
TEST(LoadCell, SettlesAndShowsTheMoment) {
  Machine machine = held();
  machine.load_cell->damping = 500.0;
  Input push;
  push.moment.x() = -5.0;  // towards +y
  const State end = reference::simulate(machine, machine.state({}, {}), 1.0,
                                        [&](double, const State&) { return push; });
  const double lever = machine.load_cell->point.z();
  EXPECT_NEAR(machine.truth(end, push).load_cell, 5.0 / lever,
              0.02);                 // [N], measured 0.011: the weight's
  EXPECT_NEAR(end.v[0], 0.0, 1e-9);  // [rad/s], measured 2.3e-12
}

}  // namespace
}  // namespace gyrotwin
