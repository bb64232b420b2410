// Modes of the sampled loop, and Routh's scheme against counted roots.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <random>

#include "clients/analyze/figures.hpp"
#include "clients/analyze/modes.hpp"
#include "clients/analyze/polynomial.hpp"
#include "services/model/eigenvalues.hpp"

namespace gyrotwin {
namespace {

/// A law that is late has as many modes as one that is not; its slow ones change by the delay.
TEST(Modes, LeaveOutTheCommandsWay) {
  Rig rig = load_rig("double_brennan");
  const std::optional<LinearModel> prompt = linear_model(rig);
  ASSERT_TRUE(prompt);
  const auto states = static_cast<Eigen::Index>(prompt->modes.states.size());
  EXPECT_EQ(prompt->modes.eigenvalues.size(), states);
  double fastest = prompt->modes.eigenvalues.real().minCoeff();
  for (const int delay : {1, 2, 3, 8}) {
    rig.loop.command_delay_ticks = delay;
    const std::optional<LinearModel> late = linear_model(rig);
    ASSERT_TRUE(late);
    EXPECT_EQ(late->modes.eigenvalues.size(), states) << delay;
    EXPECT_GT(late->modes.eigenvalues.real().minCoeff(), 2.0 * fastest) << delay;
    EXPECT_NE(late->modes.growth, prompt->modes.growth);
    // What is late damps the nutation less.
    EXPECT_GT(late->modes.growth, prompt->modes.growth - 0.05) << delay;
  }
}

/// The matrix of one tick, by hand, for a delay: growth is that of its largest eigenvalue.
TEST(Modes, ADelayCostsDamping) {
  Rig rig = load_rig("double_brennan");
  const auto nutation = [&](int delay) {
    rig.loop.command_delay_ticks = delay;
    const Eigen::VectorXcd rates = linear_model(rig)->modes.eigenvalues;
    const auto fast = std::ranges::max_element(
        rates, {}, [](const std::complex<double>& x) { return std::abs(x.imag()); });
    return fast->real();
  };
  double before = nutation(0);
  for (const int delay : {1, 2, 3}) {
    const double after = nutation(delay);
    EXPECT_GT(after, before) << delay;
    before = after;
  }
}

/// At rest, where friction of the disc acts by its slope alone.
TEST(Modes, AreExactAtRest) {
  const auto at_rest = [](const std::string& name) {
    Rig rig = load_rig(name);
    rig.controller.law = LawKind::kNone;
    std::ranges::fill(rig.initial_v, 0.0);
    return linear_model(rig);
  };
  for (const std::string name : {"prototype_b", "gooch"}) {
    const std::optional<LinearModel> linear = at_rest(name);
    ASSERT_TRUE(linear) << name;
    EXPECT_LT(linear->modes.difference, 1e-6) << name;
  }
  // Here nothing presses the axles while the disc rests: they just touch.
  const std::optional<LinearModel> touching = at_rest("prototype_b_sleeping");
  ASSERT_TRUE(touching);
  EXPECT_TRUE(touching->modes.plant_bends);
}

/// Axles that touch without a load: the ring's spring is on one side alone, and that is said.
TEST(Modes, SayWhereTheMachineBends) {
  Rig rig = load_rig("prototype_b");
  EXPECT_FALSE(linear_model(rig)->modes.plant_bends);
  rig.controller.law = LawKind::kConstantSpeed;
  rig.controller.disc_speed = 0.0;
  std::ranges::fill(rig.initial_q, 0.0);
  const std::optional<LinearModel> linear = linear_model(rig);
  ASSERT_TRUE(linear);
  EXPECT_TRUE(linear->modes.plant_bends);
  EXPECT_FALSE(linear->growth());
}

/// An estimator is not in the modes, so they do not tell the growth.
TEST(Modes, DoNotJudgeByATruthNobodySees) {
  Rig rig = load_rig("double_brennan");
  EXPECT_TRUE(linear_model(rig)->growth());
  rig.loop.state = StateSource::kEstimate;
  EXPECT_FALSE(linear_model(rig)->growth());
}

int roots_to_the_right(const Polynomial& p) {
  const auto n = static_cast<Eigen::Index>(p.size()) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    companion(0, i) = -p[static_cast<std::size_t>(i) + 1] / p[0];
  }
  int count = 0;
  for (const std::complex<double>& root : model::eigenvalues(companion)) count += root.real() > 0.0;
  return count;
}

/// Polynomials of chosen roots, away from the axis; some coefficients vanish where that leaves the
/// roots clear of it.
TEST(Routh, CountsTheRootsToTheRight) {
  std::mt19937 engine(54);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  int unstable = 0, with_zeros = 0;
  for (int i = 0; i < 4000; ++i) {
    const int degree = 2 + i % 5;
    Polynomial p{1.0};
    for (int k = 0; k < degree; ++k) p.push_back(between(-2.0, 3.0));
    if (i % 3 == 0) p[1 + static_cast<std::size_t>(i / 3) % (p.size() - 2)] = 0.0;
    Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
    companion.diagonal(-1).setOnes();
    for (int k = 0; k < degree; ++k) companion(0, k) = -p[static_cast<std::size_t>(k) + 1];
    if (model::eigenvalues(companion).real().cwiseAbs().minCoeff() < 1e-3) continue;
    const Routh scheme = routh(p);
    EXPECT_EQ(scheme.unstable, roots_to_the_right(p)) << text_of(p);
    unstable += scheme.unstable > 0 ? 1 : 0;
    with_zeros += std::ranges::count(p, 0.0) > 0 ? 1 : 0;
  }
  EXPECT_GT(unstable, 1000);
  EXPECT_GT(with_zeros, 500);
}

/// Classic cases: a first element that vanishes, and whole rows that do.
TEST(Routh, KnowsItsSpecialCases) {
  EXPECT_EQ(routh({1, 2, 2, 4, 11, 10}).unstable, 2);
  EXPECT_EQ(routh({1, 1, 2, 2, 3, 5}).unstable, 2);
  const Routh swing = routh({1, 0, 4});  // s = +-2 i
  EXPECT_EQ(swing.unstable, 0);
  EXPECT_TRUE(swing.opposite_roots);
  EXPECT_FALSE(swing.stable());
  const Routh opposite = routh({1, 0, -1});  // s = +-1
  EXPECT_EQ(opposite.unstable, 1);
  const Routh mixed = routh({1, 1, 5, 4, 4});  // (s^2 + 4)(s^2 + s + 1)
  EXPECT_EQ(mixed.unstable, 0);
  EXPECT_TRUE(mixed.opposite_roots);
  EXPECT_TRUE(routh({1, 6, 11, 6}).stable());
  const Routh to_zero = routh({1, 3, 2, 0});  // s = 0, -1, -2
  EXPECT_EQ(to_zero.unstable, 0);
}

TEST(Polynomial, IsThatOfItsRoots) {
  const Polynomial p = polynomial_of(Eigen::VectorXcd{
      {std::complex<double>(-1, 2), std::complex<double>(-1, -2), std::complex<double>(3, 0)}});
  EXPECT_EQ(p, (Polynomial{1, -1, -1, -15}));
  EXPECT_EQ(text_of(p), "s^3 - s^2 - s - 15");
}

/// Pictures vary what the rig has, about what it has.
TEST(FigureKeys, LieAboutTheRigsOwnNumbers) {
  const auto within = [](double low, double value, double high) {
    EXPECT_LT(low, value);
    EXPECT_LT(value, high);
    EXPECT_LT(std::abs(high), 3.0 * std::abs(value));
  };
  Rig rig = load_rig("prototype_b");
  auto& gyros = std::get<model::UmbrellaParameters>(rig.machine).gyros;
  for (const double sign : {1.0, -1.0}) {
    gyros.rotor_speed = sign * 1256.6;
    const FigureKeys keys = default_keys(rig);
    within(keys.locus->low, gyros.rotor_speed, keys.locus->high);
    EXPECT_EQ(keys.map->first.low, keys.locus->low);
    within(keys.map->second.low, *rig.controller.disc_speed, keys.map->second.high);
  }
  gyros.rotor_speed = 0.0;
  EXPECT_FALSE(default_keys(rig).locus);
  const Rig pair = load_rig("brennan_monorail");
  const auto& p = std::get<model::GimballedParameters>(pair.machine);
  within(default_keys(pair).map->second.low, p.structure.mass, default_keys(pair).map->second.high);
}

}  // namespace
}  // namespace gyrotwin
