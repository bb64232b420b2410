// What the formulas say of a rig, against what the rig does: in simulation, by its exact Jacobian,
// and as the model's own truth tells.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "clients/analyze/conditions.hpp"
#include "clients/analyze/umbrella_symbols.hpp"
#include "clients/common/mount.hpp"
#include "clients/simulate/trial.hpp"
#include "services/model/linearise.hpp"

namespace gyrotwin {
namespace {

using model::Mount;
using model::TrackKind;
using model::UmbrellaParameters;

UmbrellaParameters& umbrella(Rig& rig) { return std::get<UmbrellaParameters>(rig.machine); }

/// The rig with another track, its initial state kept.
Rig on_track(Rig rig, TrackKind track) {
  umbrella(rig).track = track;
  return rig;
}

Rig with_law(Rig rig, LawKind law) {
  rig.controller.law = law;
  return rig;
}

/// On a bushing alone, with its gyros free.
Rig on_bushing(Rig rig, double stiffness) {
  umbrella(rig).bushing = {stiffness, 0.0, 1.0};
  return on_track(std::move(rig), TrackKind::kNone);
}

/// The other way round: rotors and disc reversed.
Rig turned_round(Rig rig, bool rotors, bool disc) {
  if (rotors) umbrella(rig).gyros.rotor_speed *= -1.0;
  if (!disc) return rig;
  const auto phi = static_cast<std::size_t>(rig.build_machine().layout.disc);
  rig.initial_v[phi] *= -1.0;
  if (rig.controller.disc_speed) *rig.controller.disc_speed *= -1.0;
  return rig;
}

/// Disc and gyros far below their joint: they would hang.
Rig hung(Rig rig) {
  umbrella(rig).gyros.pivot_height = -0.6;
  return with_mount(std::move(rig), Mount::kUniversalJoint);
}

Rig with_speed(Rig rig, double share) {
  std::visit(
      [share](auto& p) {
        if constexpr (requires { p.gyros; }) p.gyros.rotor_speed *= share;
      },
      rig.machine);
  return rig;
}

struct Named {
  std::string name;
  Rig rig;
};

void add_umbrella_variations(const std::string& name, const Rig& rig, std::vector<Named>& all) {
  const auto add = [&](const char* how, Rig changed) {
    all.push_back({name + ", " + how, std::move(changed)});
  };
  add("mirrored", turned_round(rig, true, true));
  add("lifted", turned_round(rig, false, true));
  add("lifted by its rotors", turned_round(rig, true, false));
  add("lifted in a slot", on_track(turned_round(rig, false, true), TrackKind::kSlot));
  add("without track", on_track(rig, TrackKind::kNone));
  Rig other = rig;
  const double U = model::reduce(umbrella(other)).U;
  add("on a stiff bushing", on_bushing(rig, 4.0 * U));
  add("on a soft bushing", on_bushing(rig, 0.5 * U));
  add("disc free", with_mount(rig, Mount::kUniversalJoint));
  add("disc rigid", with_mount(rig, Mount::kRigid));
  add("hanging", hung(rig));
  add("hanging on a bushing", on_bushing(hung(rig), 1e4));
  add("rotors at rest", with_speed(rig, 0.0));
  umbrella(other).gyros.count = umbrella(other).gyros.count == 3 ? 4 : 3;
  add("another number of gyros", other);
}

std::vector<Named> rigs() {
  std::vector<Named> all;
  for (const std::string& name : shipped_rigs()) {
    const Rig rig = load_rig(name);
    all.push_back({name, rig});
    all.push_back({name + ", left alone", with_law(rig, LawKind::kNone)});
    all.push_back({name + ", slow rotors", with_speed(rig, 0.02)});
    if (std::holds_alternative<UmbrellaParameters>(rig.machine)) {
      add_umbrella_variations(name, rig, all);
    }
  }
  const Rig cell = load_rig("load_cell_rig");
  all.push_back({"load_cell_rig, speed held", with_law(cell, LawKind::kConstantSpeed)});
  Rig still = with_law(load_rig("prototype_a"), LawKind::kNone);
  still.initial_v[2] = 0.0;
  all.push_back({"prototype_a, all at rest", still});
  return all;
}

/// It comes back; a platform that parks tilted does not.
bool seen_to_stand(const Rig& rig) {
  constexpr double kWhile = 6.0;  // a fall takes a second or two here [s]
  const model::Machine machine = rig.build_machine();
  const Trial trial = run_trial(rig, machine, live_scenario(rig, machine, kWhile));
  return trial.stood() && !trial.outcome.verdict.growing() &&
         trial.end_tilt < 0.25 * trial.largest_tilt;
}

/// What fails and decides forbids standing; what comes back breaks nothing that decides.
TEST(Conditions, DecideAsTheRigDoes) {
  int broken = 0, calm = 0;
  for (const auto& [name, rig] : rigs()) {
    SCOPED_TRACE(name);
    const std::optional<LinearModel> linear = linear_model(rig);
    const Theory theory = theory_of(rig, linear);
    const auto fails = [](const Condition& c) { return c.decides() && !c.holds; };
    const auto found = std::ranges::find_if(theory.conditions, fails);
    const bool forbidden = found != theory.conditions.end();
    const std::string claim = forbidden ? found->claim : "";
    const std::optional<double> growth = linear ? linear->growth() : std::nullopt;
    if (linear && linear->modes.sound() && linear->modes.growth < -kNoGrowth) {
      EXPECT_FALSE(forbidden) << claim << ", growth " << linear->modes.growth;
      ++calm;
    }
    if (!forbidden) continue;
    ++broken;
    if (growth) {
      EXPECT_GT(*growth, kNoGrowth) << claim;
    } else {
      EXPECT_FALSE(seen_to_stand(rig)) << claim;
    }
  }
  EXPECT_GT(broken, 25);
  EXPECT_GT(calm, 15);
}

/// A mirror changes the sign of every momentum and of the disc's speed, and nothing else.
TEST(Conditions, AreTheSameInAMirror) {
  for (const std::string name : {"prototype_a", "prototype_b", "prototype_b_sleeping", "gooch"}) {
    const Rig rig = load_rig(name);
    const Rig mirrored = turned_round(rig, true, true);
    const Theory one = theory_of(rig, linear_model(rig));
    const Theory other = theory_of(mirrored, linear_model(mirrored));
    ASSERT_EQ(one.conditions.size(), other.conditions.size());
    for (std::size_t i = 0; i < one.conditions.size(); ++i) {
      const Condition &a = one.conditions[i], &b = other.conditions[i];
      SCOPED_TRACE(name + ": " + a.claim);
      EXPECT_EQ(a.key, b.key);
      EXPECT_EQ(a.holds, b.holds);
      EXPECT_EQ(a.role, b.role);
      EXPECT_NEAR(a.value, b.value, 1e-6 * std::abs(a.value) + 1e-9);  // Newton's method ends there
      if (a.compares()) {
        EXPECT_NEAR(a.required, b.required, 1e-6 * std::abs(a.required) + 1e-9);
      }
    }
  }
}

double number(const Theory& theory, const std::string& key) {
  const auto found = std::ranges::find(theory.numbers, key, &DerivedNumber::key);
  if (found == theory.numbers.end()) ADD_FAILURE() << key;
  return found == theory.numbers.end() ? std::nan("") : found->value;
}

/// The ring's numbers are what the machine feels: preload, sink, and with them the slow motions of
/// the whole machine, but for the rolling drag.
TEST(UmbrellaTheory, TiltsAsTheWholeMachine) {
  double worst = 0.0;
  for (const double speed : {3.0, 4.0, 5.0, 6.0, 8.0}) {
    Rig rig = load_rig("prototype_b_sleeping");
    umbrella(rig).contact.rolling_drag = 0.0;
    rig.controller.disc_speed = speed;
    const std::optional<LinearModel> linear = linear_model(rig);
    ASSERT_TRUE(linear);
    const Theory theory = theory_of(rig, linear);
    worst = std::max(worst, std::abs(number(theory, "tilt_growth") - linear->modes.growth));
    const model::Truth truth = rig.build_machine().truth(linear->steady.state, {});
    EXPECT_DOUBLE_EQ(number(theory, "axle_preload"), truth.contact_lower[0]);
    const model::Coordinates momentum =
        rig.build_machine().generalised_momentum(linear->steady.state);
    EXPECT_NEAR(number(theory, "axial_momentum"), momentum[rig.build_machine().layout.disc], 1e-9);
  }
  EXPECT_LT(worst, 1e-3);  // [1/s]
}

/// Numbers of the level platform against its own accelerations and momenta.
TEST(UmbrellaTheory, LevelNumbersAreTheMachines) {
  const Rig rig = with_law(load_rig("prototype_b"), LawKind::kConstantSpeed);
  const model::Machine machine = rig.build_machine();
  const Theory theory = theory_of(rig, linear_model(rig));
  const auto p = std::get<UmbrellaParameters>(rig.machine);
  const double speed = number(theory, "disc_speed");
  EXPECT_NEAR(speed, -5.0, 1e-6);

  // Gyros on the ring, nothing tilts: what the disc has is C Omega.
  const model::State turning = machine.state({0, 0, 0, p.gyros.ring_elevation}, {0, 0, speed, 0});
  EXPECT_NEAR(number(theory, "disc_inertia") * speed, machine.generalised_momentum(turning)[2],
              1e-12);
  // The axles carry h Omega each, at their lever: N h k cos tg0 of it rights the structure.
  const double lever = p.gyros.pivot_radius + p.gyros.axle_length;
  EXPECT_NEAR(number(theory, "wall_moment"), p.gyros.count * number(theory, "axle_preload") * lever,
              2e-4 * 132.0);
  // Off its ring it topples by its weight alone.
  Rig bare = on_track(rig, TrackKind::kNone);
  umbrella(bare).structure.damping = 0.0;
  const model::Linearisation about =
      linearise(bare.build_machine(), bare.build_machine().state({}, {}), {});
  const auto r = model::reduce(p);
  const double Jg = p.gyros.count *
                    (p.gyros.inertia_transverse + p.gyros.mass * std::pow(p.gyros.cm_distance, 2));
  EXPECT_NEAR(about.dq(0, 0), number(theory, "toppling_stiffness") / (r.A - Jg * r.k * r.k), 1e-9);
}

/// The gimbals' scheme sees both axes, and counts what the exact matrix has.
TEST(GimballedTheory, SeesEveryAxis) {
  Rig rig = load_rig("double_brennan");
  const Theory good = theory_of(rig, linear_model(rig));
  EXPECT_TRUE(std::ranges::all_of(good.conditions, &Condition::holds));
  rig.controller.law = LawKind::kNone;
  const Theory alone = theory_of(rig, linear_model(rig));
  const auto broken = std::ranges::find_if(
      alone.conditions, [](const Condition& c) { return c.decides() && !c.holds; });
  ASSERT_NE(broken, alone.conditions.end());
  EXPECT_EQ(broken->key, "routh");
}

/// Below its support it hangs: nothing of U has a root of a negative number.
TEST(GimballedTheory, KnowsMachinesThatHang) {
  Rig rig = load_rig("brennan_monorail");
  std::get<model::GimballedParameters>(rig.machine).structure.cm_height *= -1.0;
  rig.controller.law = LawKind::kNone;
  const Theory theory = theory_of(rig, linear_model(rig));
  for (const DerivedNumber& n : theory.numbers) EXPECT_TRUE(std::isfinite(n.value)) << n.symbol;
  for (const Condition& c : theory.conditions) EXPECT_TRUE(c.holds || !c.decides()) << c.claim;
}

}  // namespace
}  // namespace gyrotwin
