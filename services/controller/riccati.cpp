#include "services/controller/riccati.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <tuple>

#include "services/model/eigenvalues.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Newton's iteration for sign(Z), scaled by the determinant; nothing when Z has eigenvalues on the
/// imaginary axis, where the sign does not exist.
std::optional<MatrixXd> matrix_sign(MatrixXd Z) {
  constexpr int kSteps = 60;
  constexpr double kSettled = 1e-9;  // Newton's steps on P do the rest
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::PartialPivLU<MatrixXd> lu(Z);
    const double determinant = std::abs(lu.determinant());
    const double c = std::pow(determinant, -1.0 / static_cast<double>(Z.rows()));
    if (!std::isfinite(c)) return std::nullopt;
    const MatrixXd next = 0.5 * (c * Z + lu.inverse() / c);
    const double change = (next - Z).norm();
    Z = next;
    if (change <= kSettled * Z.norm()) return Z;
  }
  return std::nullopt;
}

[[noreturn]] void refuse(const std::string& why) {
  throw Error(
      "no gain stabilises the linear model: " + why +
      ". Either the drive does not reach an unstable mode, or the weights do not see a mode "
      "that never decays by itself; check the machine's numbers and the weights");
}

/// P from the sign W of the Hamiltonian matrix: the columns of [I; P] span its stable subspace,
/// which W + I maps to zero.
MatrixXd solve_by_sign(const MatrixXd& F, const MatrixXd& S, const MatrixXd& Q) {
  const Eigen::Index n = F.rows();
  MatrixXd hamiltonian(2 * n, 2 * n);
  hamiltonian << F, -S, -Q, -F.transpose();
  const std::optional<MatrixXd> W = matrix_sign(hamiltonian);
  if (!W) refuse("its Hamiltonian matrix has eigenvalues on the imaginary axis");
  const MatrixXd W1 = *W + MatrixXd::Identity(2 * n, 2 * n);
  return W1.rightCols(n).colPivHouseholderQr().solve(-W1.leftCols(n));
}

/// P with F'P + P F + Q = 0, from the n^2 linear equations in its entries.
MatrixXd solve_lyapunov(const MatrixXd& F, const MatrixXd& Q) {
  const Eigen::Index n = F.rows();
  MatrixXd L = MatrixXd::Zero(n * n, n * n);
  for (Eigen::Index j = 0; j < n; ++j) {
    L.block(j * n, j * n, n, n) += F.transpose();
    for (Eigen::Index i = 0; i < n; ++i) L.block(i * n, j * n, n, n).diagonal().array() += F(j, i);
  }
  const VectorXd p = L.partialPivLu().solve(-Q.reshaped());
  const MatrixXd P = p.reshaped(n, n);
  return 0.5 * (P + P.transpose());
}

/// Of the Riccati equation, relative to its largest term.
double residual(const MatrixXd& F, const MatrixXd& S, const MatrixXd& Q, const MatrixXd& P) {
  const MatrixXd FP = F.transpose() * P;
  const MatrixXd PSP = P * S * P;
  return (FP + FP.transpose() - PSP + Q).norm() / std::max({FP.norm(), PSP.norm(), Q.norm()});
}

}  // namespace

Eigen::VectorXcd poles(const MatrixXd& F) {
  Eigen::VectorXcd values = model::eigenvalues(F);
  std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.real(), a.imag()) < std::tuple(b.real(), b.imag());
  });
  return values;
}

Regulator solve_riccati(const MatrixXd& F, const VectorXd& B, const MatrixXd& Q, double R) {
  const MatrixXd S = B * B.transpose() / R;
  Regulator regulator;
  regulator.P = solve_by_sign(F, S, Q);
  regulator.residual = std::numeric_limits<double>::infinity();

  // Each step squares the error while F - B K is stable, until rounding stops it.
  constexpr int kSteps = 20;
  MatrixXd P = regulator.P;
  for (int i = 0; i < kSteps; ++i) {
    const MatrixXd K = B.transpose() * P / R;
    P = solve_lyapunov(F - B * K, Q + R * K.transpose() * K);
    const double now = residual(F, S, Q, P);
    if (!(now < regulator.residual)) break;
    regulator.P = P;
    regulator.residual = now;
  }
  regulator.K = B.transpose() * regulator.P / R;
  if (!regulator.K.allFinite()) refuse("the Riccati equation has no finite solution");
  regulator.poles = poles(F - B * regulator.K);

  constexpr double kLargestResidual = 1e-6;
  const double slowest = regulator.poles.real().maxCoeff();
  char why[96];
  std::snprintf(why, sizeof why, "the best one leaves a pole at %.3g 1/s, residual %.1e", slowest,
                regulator.residual);
  if (!(slowest < 0.0 && regulator.residual < kLargestResidual)) refuse(why);
  return regulator;
}

}  // namespace gyrotwin
