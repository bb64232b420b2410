// What the model's parts promise: what they refuse, and what bounds a drive.
#include <gtest/gtest.h>

#include <stdexcept>

#include "services/model/evaluate.hpp"
#include "services/model/gimballed.hpp"
#include "services/model/gyroscope.hpp"
#include "services/model/umbrella.hpp"
#include "tests/support/random_machine.hpp"
#include "tests/support/reference_data.hpp"

namespace gyrotwin {
namespace {

using model::Axis;
using model::Body;
using model::Drive;
using model::DriveMode;
using model::Gimbal;
using model::Gyro;
using model::Input;
using model::kGround;
using model::Machine;
using model::Shape;

constexpr Shape kPlain = Shape().hang(kGround, kGround, {{Axis::kX, 0}});
constexpr Shape kTurning = Shape(kPlain).with_rotor();

constexpr Shape carrying(const Shape::Gyros& gyros) { return Shape(kPlain).gimbal(0, gyros); }
constexpr Shape::Gyros kHorizontal{.pivot = model::kAlongZ,
                                   .axis = model::kAlongX,
                                   .raised = model::kAlongY,
                                   .first_rotor = 1,
                                   .rotors = 1};

/// Turns about the z axis of the body that carries it.
Gyro gyro(int rotor_index) {
  return {.pivot = {0, 0, 1},
          .axis = {1, 0, 0},
          .raised = {0, 1, 0},
          .mass = 1.0,
          .cm_distance = 0.1,
          .axial_inertia = 2.0,
          .planar_inertia = 1.0,
          .rotor_inertia = 1.0,
          .rotor_index = rotor_index};
}

template <Shape shape>
std::string refusal(const std::vector<Body>& bodies, const std::vector<Gimbal>& gimbals) {
  try {
    model::make_tree<shape>(bodies, gimbals);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TreeContract, RefusesWhatItsShapeIsNot) {
  const Body plain;
  const std::string numbers = "tree: its shape has other numbers of bodies and gimbals";
  EXPECT_EQ(refusal<kPlain>({plain}, {}), "");
  EXPECT_EQ(refusal<kPlain>({}, {}), numbers);
  EXPECT_EQ(refusal<kPlain>({plain, plain}, {}), numbers);
  EXPECT_EQ(refusal<carrying({})>({plain}, {}), numbers);
  EXPECT_EQ(refusal<kTurning>({plain}, {}), "tree: no such rotor");
  Body body;
  body.rotor_index = 4;
  EXPECT_EQ(refusal<kTurning>({body}, {}), "tree: no such rotor");
  body.rotor_index = 0;
  EXPECT_EQ(refusal<kPlain>({body}, {}),
            "tree: body 0 has a rotor that its shape has not: with_rotor()");
  body = plain;
  body.cm = {0.1, 0, 0};
  EXPECT_EQ(refusal<kPlain>({body}, {}),
            "tree: body 0 has its centre of mass off its shape's axes: cm_along()");
  body = plain;
  body.pivot = {0, 0.1, 0};
  EXPECT_EQ(refusal<kPlain>({body}, {}),
            "tree: body 0 has its pivot off its shape's axes: pivot_along()");
}

template <Shape::Gyros gyros>
bool fits(const Gyro& gyro) {
  const std::string error = refusal<carrying(gyros)>({Body()}, {Gimbal({gyro})});
  EXPECT_TRUE(error.empty() ||
              error == "tree: the gyros of gimbal 0 do not lie as its shape says: gimbal()");
  return error.empty();
}

constexpr Shape::Gyros with_centre_on_hinge(Shape::Gyros gyros) {
  gyros.centred = true;
  return gyros;
}
constexpr Shape::Gyros balanced(Shape::Gyros gyros) {
  gyros.balanced = true;
  return gyros;
}

TEST(TreeContract, RefusesGyrosThatDoNotLieAsItsShapeSays) {
  EXPECT_THROW(Gimbal(std::vector<Gyro>(5, gyro(0))), std::invalid_argument);
  EXPECT_THROW(Gimbal({gyro(4)}), std::invalid_argument);
  EXPECT_TRUE(fits<Shape::Gyros{}>(gyro(0)));
  EXPECT_TRUE(fits<kHorizontal>(gyro(1)));
  EXPECT_FALSE(fits<kHorizontal>(gyro(0)));
  EXPECT_FALSE(fits<kHorizontal>(gyro(2)));
  EXPECT_FALSE(fits<with_centre_on_hinge(kHorizontal)>(gyro(1)));
  EXPECT_FALSE(fits<balanced(kHorizontal)>(gyro(1)));
  Gyro off = gyro(1);
  off.pivot.y() = 0.1;
  EXPECT_FALSE(fits<kHorizontal>(off));
  Gyro tilted = gyro(1);
  tilted.axis = {0.6, 0, 0.8};
  EXPECT_FALSE(fits<kHorizontal>(tilted));
  Gyro vertical = gyro(1);
  vertical.raised = {0, 0, 1};
  EXPECT_FALSE(fits<kHorizontal>(vertical));
}

/// One body that leans, with one gyro that is neither balanced nor has its cm on its hinge.
TEST(TreeContract, KnowsNoLessOfGyrosThanOfAnyOthers) {
  Body body;
  body.mass = 2.0;
  body.cm.z() = 0.5;
  body.inertia = {1.0, 2.0, 3.0};
  const std::vector<Gimbal> gimbals{Gimbal({gyro(1)})};
  const model::Tree known = model::make_tree<carrying(kHorizontal)>({body}, gimbals);
  const model::Tree any = model::make_tree<carrying({})>({body}, gimbals);
  model::Coordinates q = model::Coordinates::Zero(), v = q;
  q.head<2>() << 0.4, 0.7;
  v.head<2>() << -2.0, 3.0;
  const model::RotorSpeeds speed{0, 100, 0, 0}, rate{0, 5, 0, 0};
  const model::Support support{{1.0, 2.0, 9.81}, 0.3};
  model::Motion a, b;
  known.evaluate(q, v, {speed, rate}, support, a);
  any.evaluate(q, v, {speed, rate}, support, b);
  const model::Coordinates x = known.solve(a.M, a.f), y = any.solve(b.M, b.f);
  EXPECT_NE(x[0], 0.0);
  EXPECT_LT((x - y).cwiseAbs().maxCoeff(), 1e-13 * y.cwiseAbs().maxCoeff());
}

// What is solved apart: nothing turns the disc of a level mount but itself, and no gimbal of a pair
// feels the tilt's acceleration.
constexpr bool coupled(const Shape& shape, int i, int j) {
  return model::coupling_of(shape).has(i, j);
}
constexpr Shape kLevel = model::shape_of(model::Mount::kLevel);
static_assert(coupled(kLevel, 0, 1) && coupled(kLevel, 0, 3) && coupled(kLevel, 1, 3));
static_assert(!coupled(kLevel, 2, 0) && !coupled(kLevel, 2, 1) && !coupled(kLevel, 2, 3));
constexpr Shape kPair = model::shape_of(model::Arrangement::kPair);
static_assert(!coupled(kPair, 0, 1));
static_assert(coupled(model::kGyroscopeShape, 0, 1));

TEST(BuilderContract, UmbrellaHasThreeOrFourGyros) {
  auto p = reference::umbrella("prototype_b");
  for (int count : {2, 5}) {
    p.gyros.count = count;
    EXPECT_THROW(model::build(p), std::invalid_argument);
  }
}

/// Kt G = 0.6 N m/A: numbers that can be followed by hand, exact but for rounding (1e-12).
TEST(DriveContract, MotorLineBoundsIt) {
  const Drive drive{Drive::Kind::kDisc, 2, model::Motor{0.05, 12.0, 0.35, 24.0}, 30.0};
  const double slope = 0.36 / 0.35, stall = 0.6 * 24.0 / 0.35;  // 41.1 N m, above the limit
  EXPECT_EQ(drive.range(0.0)[0], -30.0);
  EXPECT_EQ(drive.range(0.0)[1], 30.0);
  EXPECT_NEAR(drive.range(20.0)[1], stall - 20.0 * slope, 1e-12);
  EXPECT_EQ(drive.range(20.0)[0], -30.0);
  EXPECT_NEAR(drive.range(40.0)[1], 0.0, 1e-12);  // no-load speed Vb / (Kt G)

  EXPECT_EQ(drive.torque(DriveMode::kTorque, 5.0, 20.0), 5.0);
  EXPECT_NEAR(drive.torque(DriveMode::kTorque, 50.0, 20.0), stall - 20.0 * slope, 1e-12);
  EXPECT_EQ(drive.torque(DriveMode::kTorque, -50.0, 20.0), -30.0);
  EXPECT_EQ(drive.torque(DriveMode::kIdealTorque, 50.0, 20.0), 50.0);

  // Voltage: beyond the supply it is cut; at 0 V the motor is shorted and brakes.
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 12.0, 5.0), 0.6 * (12.0 - 3.0) / 0.35, 1e-12);
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 99.0, 20.0), stall - 20.0 * slope, 1e-12);
  EXPECT_NEAR(drive.torque(DriveMode::kVoltage, 0.0, 5.0), -5.0 * slope, 1e-12);
}

TEST(DriveContract, WithoutMotorTheLimitBoundsIt) {
  const Drive drive{Drive::Kind::kGimbal, 1, std::nullopt, 3.0};
  EXPECT_EQ(drive.range(100.0), (std::array{-3.0, 3.0}));
  EXPECT_EQ(drive.torque(DriveMode::kTorque, 5.0, 100.0), 3.0);
  EXPECT_EQ(drive.torque(DriveMode::kVoltage, 5.0, 100.0), 0.0);
}

/// Turning faster than the supply can follow, the motor only brakes: the range excludes 0.
TEST(DriveContract, OverspeedBrakes) {
  const Drive drive{Drive::Kind::kDisc, 2, model::Motor{0.05, 12.0, 0.35, 24.0}, 1e9};
  EXPECT_LT(drive.range(50.0)[1], 0.0);
  EXPECT_EQ(drive.torque(DriveMode::kTorque, 0.0, 50.0), drive.range(50.0)[1]);
}

TEST(MachineContract, TruthSaysWhatTheDriveStillCan) {
  auto p = reference::umbrella("prototype_b");
  p.drive.torque_limit = 30.0;
  const Machine machine = model::build(p);
  Input input;
  input.drive[0] = -5.0;
  const model::Truth truth = machine.truth(machine.state({}, {0, 0, 20.0, 0}), input);
  EXPECT_EQ(truth.drive_torque[0], -5.0);
  EXPECT_EQ(truth.drive_margin[0], 25.0);

  // A weak drive: of what it would exert, a share arrives.
  input.drive_strength[0] = 0.5;
  const model::Truth weak = machine.truth(machine.state({}, {0, 0, 20.0, 0}), input);
  EXPECT_EQ(weak.drive_torque[0], -2.5);
  EXPECT_EQ(weak.drive_margin[0], 12.5);
}

TEST(Effort, IsThatOfTheTruth) {
  reference::Random random(8);
  for (const model::Machine& machine : random.machines()) {
    for (const DriveMode mode : {DriveMode::kTorque, DriveMode::kBrake, DriveMode::kIdealTorque}) {
      const model::State state = random.state(machine, 0.3, 2.0);
      Input input = random.input();
      input.mode = mode;
      const model::Truth truth = machine.truth(state, input);
      const model::Effort effort = machine.effort(state, input);
      EXPECT_EQ(effort.drive_torque, truth.drive_torque);
      EXPECT_EQ(effort.drive_margin, truth.drive_margin);
      EXPECT_EQ(effort.holding_moment, truth.holding_moment);
      EXPECT_NE(effort.drive_torque[0], 0.0);
      EXPECT_EQ(effort.holding_moment[0] != 0.0, machine.unheld.has_value());
    }
  }
}

}  // namespace
}  // namespace gyrotwin
