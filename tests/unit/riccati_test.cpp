// The Riccati solver against closed forms, badly scaled systems and systems that have no solution.
#include "services/controller/riccati.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "services/runtime/error.hpp"

namespace gyrotwin {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Riccati, ScalarHasItsQuadraticFormula) {
  const double f = 3.0, b = 0.5, q = 7.0, r = 0.2;
  const MatrixXd F = MatrixXd::Constant(1, 1, f);
  const Regulator regulator =
      solve_riccati(F, VectorXd::Constant(1, b), MatrixXd::Constant(1, 1, q), r);
  const double root = std::sqrt(f * f + b * b * q / r);
  EXPECT_NEAR(regulator.P(0, 0), r * (f + root) / (b * b), 1e-14);  // measured 0
  EXPECT_NEAR(regulator.poles[0].real(), -root, 1e-14);             // measured 0
}

TEST(Riccati, DoubleIntegrator) {
  MatrixXd F(2, 2);
  F << 0.0, 1.0, 0.0, 0.0;
  const Regulator regulator =
      solve_riccati(F, Eigen::Vector2d(0.0, 1.0), MatrixXd::Identity(2, 2), 1.0);
  MatrixXd P(2, 2);
  P << std::sqrt(3.0), 1.0, 1.0, std::sqrt(3.0);
  EXPECT_LT((regulator.P - P).norm(), 1e-14);           // measured 3.1e-16
  EXPECT_NEAR(regulator.poles[0].imag(), -0.5, 1e-14);  // measured 1.1e-16
  EXPECT_NEAR(regulator.poles[1].imag(), 0.5, 1e-14);   // measured 1.1e-16
}

// x'' = w^2 x + u, cost q x^2 + r u^2: the poles are the stable roots of s^4 - 2 w^2 s^2 + w^4 +
// q/r.
TEST(Riccati, InvertedPendulum) {
  const double w2 = 9.0, q = 400.0, r = 0.25;
  MatrixXd F(2, 2);
  F << 0.0, 1.0, w2, 0.0;
  const MatrixXd Q = Eigen::Vector2d(q, 0.0).asDiagonal();
  const Regulator regulator = solve_riccati(F, Eigen::Vector2d(0.0, 1.0), Q, r);
  const double k1 = w2 + std::sqrt(w2 * w2 + q / r);
  EXPECT_NEAR(regulator.K[0], k1, 1e-13 * k1);                   // measured 0
  EXPECT_NEAR(regulator.K[1], std::sqrt(2.0 * k1), 1e-14 * k1);  // measured 1.8e-15
}

// With Q = 0 the regulator mirrors the unstable poles and leaves the stable ones: least effort.
TEST(Riccati, LeastEffortMirrorsUnstablePoles) {
  MatrixXd F(3, 3);
  F << 2.0, 1.0, 0.0, 0.0, 5.0, 1.0, 0.0, 0.0, -3.0;
  const Regulator regulator =
      solve_riccati(F, Eigen::Vector3d(0.0, 0.0, 1.0), MatrixXd::Zero(3, 3), 1.0);
  const double expected[] = {-5.0, -3.0, -2.0};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(regulator.poles[i].real(), expected[i], 1e-10);  // measured 3.9e-13
}

/// A machine with gimbals in physical units: A, J, U, H span many orders of magnitude.
struct Scale {
  double A, J, U, H, tilt_max, gimbal_max, torque_max;
};

class BadlyScaled : public testing::TestWithParam<Scale> {};

TEST_P(BadlyScaled, ResidualIsSmallAndPPositiveDefinite) {
  const Scale s = GetParam();
  MatrixXd F = MatrixXd::Zero(4, 4);
  F(0, 1) = F(2, 3) = 1.0;
  F(1, 0) = s.U / s.A;
  F(1, 3) = s.H / s.A;
  F(3, 1) = -s.H / s.J;
  const VectorXd B = Eigen::Vector4d(0.0, 0.0, 0.0, 1.0 / s.J);
  const MatrixXd Q =
      Eigen::Vector4d(std::pow(s.tilt_max, -2), 0.0, std::pow(s.gimbal_max, -2), 0.0).asDiagonal();
  const Regulator regulator = solve_riccati(F, B, Q, std::pow(s.torque_max, -2));
  EXPECT_LT(regulator.residual, 1e-13);  // measured 2.1e-16
  EXPECT_EQ(regulator.P, regulator.P.transpose());
  EXPECT_EQ(regulator.P.llt().info(), Eigen::Success);
  EXPECT_LT(regulator.poles.real().maxCoeff(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Machines, BadlyScaled,
    testing::Values(Scale{113.6e3, 120.0, 494e3, 55.8e3, 0.03, 0.12, 8000.0},  // a railway carriage
                    Scale{0.360, 0.0044, 12.9, 5.28, 0.03, 0.10, 2.0},         // on a table
                    Scale{2e-6, 3e-9, 4e-4, 1e-5, 0.03, 0.10, 1e-5},           // in a hand
                    Scale{4e7, 5e4, 2e8, 3e7, 0.03, 0.12, 4e6}));              // a ship

// Random systems of the sizes in use, many orders of magnitude apart in their coordinates.
TEST(Riccati, RandomSystems) {
  std::mt19937_64 random(20240607);
  std::normal_distribution<double> normal;
  double worst = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const int n = 3 + i % 2;
    MatrixXd F = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    VectorXd B = VectorXd::NullaryExpr(n, [&] { return normal(random); });
    VectorXd scale = VectorXd::NullaryExpr(n, [&] { return std::pow(10.0, normal(random)); });
    F = scale.asDiagonal() * F * scale.cwiseInverse().asDiagonal();
    B = scale.asDiagonal() * B;
    const MatrixXd Q = scale.cwiseInverse().cwiseAbs2().asDiagonal();
    const Regulator regulator = solve_riccati(F, B, Q, std::pow(10.0, normal(random)));
    worst = std::max(worst, regulator.residual);
    EXPECT_LT(regulator.poles.real().maxCoeff(), 0.0);
  }
  EXPECT_LT(worst, 1e-7);  // measured 8.6e-9, median 4.8e-16: a few are nearly out of reach
}

TEST(Riccati, RefusesAnUnstableModeThatTheInputDoesNotReach) {
  for (const double unreached : {0.5, 0.0}) {
    const MatrixXd F = Eigen::Vector3d(unreached, -1.0, 2.0).asDiagonal();
    EXPECT_THROW(solve_riccati(F, Eigen::Vector3d(0.0, 1.0, 1.0), MatrixXd::Identity(3, 3), 1.0),
                 Error)
        << "mode at " << unreached;
  }
}

TEST(Riccati, RefusesAnUndampedModeThatTheWeightsDoNotSee) {
  MatrixXd F(2, 2);
  F << 0.0, 1.0, -4.0, 0.0;
  EXPECT_THROW(solve_riccati(F, Eigen::Vector2d(0.0, 1.0), MatrixXd::Zero(2, 2), 1.0), Error);
}

TEST(Riccati, AcceptsAStableModeThatTheInputDoesNotReach) {
  const MatrixXd F = Eigen::Vector2d(-1.0, 2.0).asDiagonal();
  const Regulator regulator =
      solve_riccati(F, Eigen::Vector2d(0.0, 1.0), MatrixXd::Identity(2, 2), 1.0);
  EXPECT_NEAR(regulator.poles[0].real(), -std::sqrt(5.0), 1e-14);  // measured 0
  EXPECT_NEAR(regulator.poles[1].real(), -1.0, 1e-14);             // measured 0
}

}  // namespace
}  // namespace gyrotwin
