// What an analysis makes of what it has seen: standing and sentence, reason, limits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "clients/analyze/limits.hpp"
#include "clients/analyze/reasons.hpp"
#include "clients/analyze/words.hpp"
#include "clients/common/tilt.hpp"
#include "tests/support/law_rigs.hpp"

namespace gyrotwin {
namespace {

/// A run of 10 s in which the first coordinate goes its way [deg].
Trial trial_of(const Rig& rig, const std::function<double(double)>& way) {
  const model::Machine machine = rig.build_machine();
  Trial trial;
  trial.outcome = {.t = 10.0, .verdict = Verdict(rig, machine, 10.0)};
  for (int k = 0; k <= 1000; ++k) {
    model::State state = machine.state({}, {});
    state.q[0] = radians(way(0.01 * k));
    trial.outcome.verdict.note(0.01 * k, machine, state);
  }
  trial.end_tilt = trial.outcome.verdict.tilt();
  trial.largest_tilt = trial.outcome.verdict.largest_tilt();
  trial.least_gimbal_margin = 0.5;
  return trial;
}

double fades(double t) { return 5.0 * std::exp(-t); }
double stays(double) { return 3.0; }
double creeps(double t) { return 0.1 * std::exp(0.1 * t); }
double topples(double t) { return std::exp(t); }

Case judged(const Rig& rig, double (*alone)(double), double (*pushed)(double),
            std::optional<double> growth) {
  Case seen;
  seen.undisturbed = trial_of(rig, alone);
  if (pushed != nullptr) seen.pushed = trial_of(rig, pushed);
  if (growth) {
    seen.linear.emplace();
    seen.linear->modes.growth = *growth;
  }
  judge(rig, seen);
  return seen;
}

TEST(Judge, TellsHowARigFares) {
  const Rig rig = reference::double_brennan();
  const auto standing = [&](double (*alone)(double), double (*pushed)(double),
                            std::optional<double> growth) {
    return judged(rig, alone, pushed, growth).standing;
  };
  EXPECT_EQ(standing(fades, fades, -1.0), Standing::kStands);
  EXPECT_EQ(standing(topples, nullptr, -1.0), Standing::kFalls);
  EXPECT_EQ(standing(fades, topples, -1.0), Standing::kDoubtful);
  EXPECT_EQ(standing(stays, stays, 0.0), Standing::kNeutral);
  EXPECT_EQ(standing(stays, stays, -1.0), Standing::kStands) << "it would come back";
  EXPECT_EQ(standing(creeps, stays, 0.1), Standing::kDoubtful);
  EXPECT_EQ(standing(creeps, stays, std::nullopt), Standing::kDoubtful);
  EXPECT_EQ(standing(creeps, fades, -1.0), Standing::kStands) << "it is known to die out";
  EXPECT_EQ(standing(fades, fades, 4e-14), Standing::kStands) << "rounding is no growth";
  EXPECT_EQ(judged(rig, creeps, stays, 0.1).sentence,
            "stands so far: tilt at most 0.272 deg, 0.272 deg after 10 s, and growing by 0.1 1/s: "
            "it doubles in 6.93 s and falls after about 59.9 s");
  EXPECT_EQ(judged(rig, fades, fades, 5.0).sentence,
            "stands: tilt at most 5 deg, 0.000227 deg after 10 s; upright itself is unstable, it "
            "keeps moving about it");
}

/// The push is judged as the undisturbed run is.
TEST(Judge, DoubtsWhatStillGrowsAfterItsPush) {
  const Rig rig = reference::double_brennan();
  const Case seen = judged(rig, stays, creeps, std::nullopt);
  EXPECT_EQ(seen.standing, Standing::kDoubtful);
  EXPECT_NE(seen.sentence.find("its tilt still grows"), std::string::npos) << seen.sentence;
  EXPECT_EQ(judged(rig, stays, creeps, -1.0).standing, Standing::kStands) << "it dies out";
}

/// Toppled onto its stops it stays where it is, and does not stand.
TEST(Judge, SeesThatTheStopsHoldIt) {
  Rig rig = load_rig("prototype_b");
  std::get<model::UmbrellaParameters>(rig.machine).gyros.rotor_speed = 0.0;
  const Case seen = run_case(rig, "as_filed", "", 6.0);
  EXPECT_EQ(seen.standing, Standing::kLeans);
  EXPECT_TRUE(seen.sentence.starts_with("leans on its gimbal stops at 23")) << seen.sentence;
  const std::string reason = reason_for(rig, seen, theory_of(rig, seen.linear));
  EXPECT_NE(reason.find("H^2 > C U"), std::string::npos) << reason;
}

/// When it was pushed is not when it fell.
TEST(Words, SayWhenThePushCameAndWhatWasLater) {
  const Rig rig = reference::double_brennan();
  const auto said = [&](double (*pushed)(double)) {
    Case seen = judged(rig, fades, pushed, std::nullopt);
    seen.push_at = 2.0;
    return push_words(seen);
  };
  EXPECT_EQ(said(fades), "at 2 s: 8 s later it stands, tilt at most 5 deg");
  EXPECT_EQ(said(creeps),
            "at 2 s: 8 s later it still stands, and its motion grows, tilt at most 0.272 deg");
  // exp(t) passes the fall limit of 0.7 rad, 40.1 deg, at 3.69 s.
  EXPECT_TRUE(said(topples).starts_with("at 2 s: 1.69 s later it falls")) << said(topples);
  EXPECT_EQ(said(nullptr), "");
}

Theory theory_with(const std::vector<Condition>& conditions) { return {{}, conditions, {}}; }

const Condition kDecides = below("a", "a < 1", "it would fall", 2.0, 1.0, "s", Role::kDecides);
const Condition kExplains = above("b", "b > 3", "it helps", 1.0, 3.0, "", Role::kExplains);
const Condition kAdvises = above("c", "c > 3", "good to have", 1.0, 3.0, "", Role::kAdvises);
const Condition kHolds = above("d", "d > 2", "all is well", 3.0, 2.0, "", Role::kDecides);
const Condition kYes = yes_no("e", "a track", "there is one", true, Role::kDecides);
const Condition kNo = yes_no("e", "a track", "there is one", false, Role::kDecides);

TEST(Reason, NamesWhatDecidesAndThenWhatExplains) {
  const Rig rig = reference::double_brennan();
  const Case fell = judged(rig, topples, nullptr, 1.0);
  EXPECT_EQ(reason_for(rig, fell, theory_with({kAdvises, kExplains, kHolds, kDecides})),
            "the gimbals are driven, and this does not hold: a < 1 (2 against 1 s): it would fall; "
            "this rule is broken: b > 3 (1 against 3): it helps");
  EXPECT_EQ(reason_for(rig, fell, theory_with({kAdvises, kNo})),
            "the gimbals are driven, and this does not hold: a track: there is one");
  EXPECT_EQ(reason_for(rig, fell, theory_with({kAdvises, kExplains})),
            "the gimbals are driven, and small deviations grow by 1 1/s; this rule is broken: b > "
            "3 (1 against 3): it helps");
  EXPECT_EQ(reason_for(rig, judged(rig, topples, nullptr, 4e-14), theory_with({kAdvises})),
            "the gimbals are driven, and no linear condition forbids it to stand: it is taken too "
            "far from upright");
}

/// What the formulas do not know is told of the run itself.
TEST(Reason, TellsOfSlowRotorsAndDrivesAtTheirLimit) {
  const Rig rig = reference::double_brennan();
  Case fell = judged(rig, topples, nullptr, -1.0);
  fell.undisturbed.first_rotor_share = 0.3;
  fell.undisturbed.at_limit = 0.8;
  fell.undisturbed.largest_torque = 3.0;
  EXPECT_EQ(reason_for(rig, fell, theory_with({kExplains})),
            "the gimbals are driven, and its slowest rotor begins at 30 % of its nominal speed; a "
            "drive is at its limit for 80 % of the run, 3 N m at most");
}

TEST(Reason, NamesTheClosestThatHasAMargin) {
  const Rig rig = reference::double_brennan();
  EXPECT_EQ(reason_for(rig, judged(rig, fades, fades, -2.0), theory_with({kYes, kHolds})),
            "the gimbals are driven, small deviations die out at 2 1/s; nothing that it hangs on "
            "fails, closest is d > 2 with a factor 1.5");
  EXPECT_EQ(reason_for(rig, judged(rig, fades, fades, -4e-14), theory_with({kYes})),
            "the gimbals are driven");
  EXPECT_EQ(reason_for(rig, judged(rig, stays, stays, std::nullopt), theory_with({kNo})),
            "the gimbals are driven; it does not come back upright, for this does not hold: a "
            "track: there is one");
}

TEST(Condition, OfYesAndNoHasNoMargin) {
  EXPECT_FALSE(kYes.compares());
  EXPECT_FALSE(std::isfinite(kYes.margin));
  EXPECT_EQ(kYes.value, 1.0);
  EXPECT_FALSE(kNo.holds);
  EXPECT_DOUBLE_EQ(kHolds.margin, 1.5);
  EXPECT_DOUBLE_EQ(kDecides.margin, 0.5);
}

/// A platform that stands loads up to `end`, tilting by their size.
std::function<Attempt(double)> up_to(double end, int& tries) {
  return [end, &tries](double strength) {
    ++tries;
    return Attempt{strength <= end ? Fate::kStands : Fate::kLeans, 0.01 * strength};
  };
}

TEST(Bracket, ClosesInOnTheEnd) {
  for (const double end : {0.003, 0.7, 1.0, 1.5, 2.0, 300.0}) {
    int tries = 0;
    const Bracket bracket = bracket_of(up_to(end, tries), 1.0);
    EXPECT_LE(bracket.stands, end);
    EXPECT_GT(bracket.ends, end);
    EXPECT_LE(bracket.ends, 1.02 * bracket.stands);
    EXPECT_DOUBLE_EQ(bracket.largest_tilt, 0.01 * bracket.stands);
    EXPECT_EQ(bracket.how, Fate::kLeans);
    EXPECT_LT(tries, 25);
  }
}

TEST(Bracket, HasAnOpenEndWhereThereIsNone) {
  int tries = 0;
  const Bracket all = bracket_of(up_to(1e9, tries), 1.0);
  EXPECT_DOUBLE_EQ(all.stands, 16384.0);
  EXPECT_TRUE(std::isinf(all.ends));
  EXPECT_EQ(tries, 15);
  const Bracket none = bracket_of(up_to(0.0, tries), 1.0);
  EXPECT_EQ(none.stands, 0.0);
  EXPECT_DOUBLE_EQ(none.ends, 1.0 / 16384.0);
  EXPECT_EQ(none.largest_tilt, 0.0);
}

/// What grows at the end counts as fallen only where it has come far.
TEST(Limits, StandTheLoadsThatTheyName) {
  Rig rig = load_rig("double_brennan");
  const std::vector<Limit> limits = limits_of(rig, 0.5, 2.0, 2);
  ASSERT_EQ(limits.size(), 6u);
  for (const Limit& limit : limits) {
    EXPECT_GT(limit.bracket.stands, 0.0) << limit.key;
    EXPECT_LE(limit.bracket.ends, 1.02 * limit.bracket.stands) << limit.key;
    EXPECT_LT(limit.bracket.largest_tilt, rig.safety.fall_tilt_rad) << limit.key;
  }
}

}  // namespace
}  // namespace gyrotwin
