// Eigenvalues of a real matrix.
#pragma once

#include <Eigen/Core>

namespace gyrotwin::model {

/// All of them, in no particular order, pairs of conjugates next to each other.
/// @param A square, n x n [1/s for the matrix of x' = A x]
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

}  // namespace gyrotwin::model
