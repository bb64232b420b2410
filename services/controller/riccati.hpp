// The linear-quadratic regulator of a small system with one input.
#pragma once

#include <Eigen/Core>

namespace gyrotwin {

/// Feedback u = -K x of the system x' = F x + B u that minimises the integral of x'Q x + R u^2.
struct Regulator {
  Eigen::MatrixXd P;       ///< stabilising solution of F'P + P F - P B B'P / R + Q = 0
  Eigen::RowVectorXd K;    ///< B'P / R
  Eigen::VectorXcd poles;  ///< of F - B K [1/s], see poles()
  double residual;         ///< of the equation, relative to its largest term [1]
};

/// Solves the continuous-time algebraic Riccati equation by the sign of its Hamiltonian matrix,
/// then Newton steps (Kleinman).
/// @pre F is n x n, B n long, Q symmetric positive semidefinite n x n, R > 0
/// @throws Error when no gain stabilises: the input does not reach an unstable mode, or Q does not
///         see one on the imaginary axis
Regulator solve_riccati(const Eigen::MatrixXd& F, const Eigen::VectorXd& B,
                        const Eigen::MatrixXd& Q, double R);

/// Eigenvalues [1/s], the fastest-decaying first, of a conjugate pair the lower first.
Eigen::VectorXcd poles(const Eigen::MatrixXd& F);

}  // namespace gyrotwin
