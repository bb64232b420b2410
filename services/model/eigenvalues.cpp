#include "services/model/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace gyrotwin::model {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A) { return A.eigenvalues(); }

}  // namespace gyrotwin::model
