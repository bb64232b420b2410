#include "clients/calibrate/information.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace gyrotwin::calibration {

namespace {

constexpr double kNoInformation = 1e-9;  // of a singular value against the largest
constexpr double kPartOf = 0.2;          // share of a direction that makes a parameter part of it

/// R of A = Q R, as many rows as matter.
Eigen::MatrixXd triangular(const Eigen::MatrixXd& A) {
  if (A.rows() == 0) return A;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::Index rows = std::min(A.rows(), A.cols());
  return qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
}

/// What the rows say of the other unknowns, whatever the first `columns` are. Of those that no row
/// hangs on, no row is lost either: hence the pivoting.
Eigen::MatrixXd without(const Eigen::MatrixXd& A, Eigen::Index columns) {
  if (columns == 0 || A.rows() == 0) return triangular(A.rightCols(A.cols() - columns));
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A.leftCols(columns));
  const Eigen::MatrixXd turned = qr.householderQ().adjoint() * A.rightCols(A.cols() - columns);
  return triangular(turned.bottomRows(A.rows() - qr.rank()));
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() == 0) return b;
  if (b.rows() == 0) return a;
  Eigen::MatrixXd all(a.rows() + b.rows(), a.cols());
  all << a, b;
  return all;
}

}  // namespace

InformationFilter::InformationFilter(Eigen::Index parameters, const std::vector<Bias>& biases)
    : parameters_(parameters),
      biases_(static_cast<Eigen::Index>(biases.size())),
      carried_(0, 0),
      known_(Eigen::MatrixXd::Zero(biases_, biases_ + parameters)) {
  for (Eigen::Index i = 0; i < biases_; ++i) {
    known_(i, i) = 1.0 / biases[static_cast<std::size_t>(i)].sigma;
  }
}

void InformationFilter::add(const Segment& segment, const Shot& shot, int coordinates) {
  const Eigen::Index n = segment.start.size();
  const Eigen::Index next = segment.continued ? n : 0;
  const Eigen::Index rows = shot.residual.size();
  const auto readings = static_cast<Eigen::Index>(segment.rows.size());
  // Unknowns: start | next start | biases | parameters.
  Eigen::MatrixXd A =
      Eigen::MatrixXd::Zero(rows + carried_.rows(), n + next + biases_ + parameters_);
  A.topLeftCorner(rows, n) = shot.by_start;
  A.topRightCorner(rows, parameters_) = shot.by_parameter;
  for (Eigen::Index i = 0; i < readings; ++i) {
    const Row& row = segment.rows[static_cast<std::size_t>(i)];
    if (row.bias >= 0) A(i, n + next + row.bias) = 1.0 / row.sigma;
  }
  for (Eigen::Index i = 0; i < next; ++i)
    A(readings + i, n + i) = -1.0 / seam_sigma(i, coordinates);
  if (carried_.rows() > 0) {
    A.bottomLeftCorner(carried_.rows(), n) = carried_.leftCols(n);
    A.bottomRightCorner(carried_.rows(), biases_ + parameters_) =
        carried_.rightCols(biases_ + parameters_);
  }
  carried_ = without(A, n);
  if (segment.continued) return;
  known_ = triangular(stacked(known_, carried_));
  carried_.resize(0, 0);
}

Eigen::MatrixXd InformationFilter::root() const {
  const Eigen::MatrixXd R = without(known_, biases_);
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(parameters_, parameters_);
  full.topRows(R.rows()) = R;
  return full;
}

Identifiability identify(const Eigen::MatrixXd& root, double inflation) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(root, Eigen::ComputeFullV);
  Identifiability all;
  all.singular = svd.singularValues() / inflation;
  all.directions = svd.matrixV();
  const Eigen::Index n = root.cols();
  const double least = kNoInformation * (n > 0 ? all.singular[0] : 0.0);
  Eigen::VectorXd variance(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double s = all.singular[i];
    variance[i] = s > least ? 1.0 / (s * s) : std::numeric_limits<double>::infinity();
  }
  all.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const double share = all.directions(i, k) * all.directions(j, k);
        if (std::abs(share) > 1e-12) all.covariance(i, j) += variance[k] * share;
      }
    }
  }
  const Eigen::VectorXd deviation = all.covariance.diagonal().cwiseSqrt();
  all.correlation = all.covariance.cwiseQuotient(deviation * deviation.transpose());
  for (Eigen::Index i = 0; i < n; ++i) {
    Knowledge knowledge{deviation[i], inflation / root.col(i).norm(), {}};
    Eigen::Index weakest = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double now = std::abs(all.directions(i, k)) / all.singular[k];
      const double best = std::abs(all.directions(i, weakest)) / all.singular[weakest];
      if (!(now <= best)) weakest = k;
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      if (j != i && std::abs(all.directions(j, weakest)) > kPartOf) {
        knowledge.entangled.push_back(static_cast<std::size_t>(j));
      }
    }
    all.of.push_back(std::move(knowledge));
  }
  return all;
}

}  // namespace gyrotwin::calibration
