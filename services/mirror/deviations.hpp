// An uncertainty as deviations: rows d_k with the covariance P = sum of d_k' d_k. README.md, "The
// filter".
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace gyrotwin {

/// Columns are quantities, rows independent deviations of size one sigma. P = D' D is positive
/// whatever happens to D: nothing is ever subtracted from a covariance.
class Deviations {
 public:
  static constexpr int kMaxColumns = 32;
  static constexpr int kMaxRows = 120;  ///< of 32 quantities with all noise and all doubts

  /// All certain.
  explicit Deviations(int columns) : columns_(columns) {}

  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  auto used() noexcept { return D_.topLeftCorner(rows_, columns_); }
  auto used() const noexcept { return D_.topLeftCorner(rows_, columns_); }
  auto column(int i) noexcept { return D_.col(i).head(rows_); }
  auto column(int i) const noexcept { return D_.col(i).head(rows_); }
  auto row(int k) noexcept { return D_.row(k).head(columns_); }
  auto row(int k) const noexcept { return D_.row(k).head(columns_); }
  double sigma(int i) const noexcept { return column(i).norm(); }

  /// One row more, of 0. @return its index
  int extend() noexcept {
    D_.row(rows_).setZero();
    return rows_++;
  }
  /// The first so many rows alone.
  void cut(int rows) noexcept { rows_ = rows; }
  /// So many rows of 0.
  void clear(int rows) noexcept {
    rows_ = rows;
    used().setZero();
  }
  void take(const Deviations& other, int rows) noexcept {
    rows_ = rows;
    used() = other.D_.topLeftCorner(rows_, columns_);
  }

  /// The same covariance in as many rows as columns, upper triangular (Householder).
  void compress() noexcept {
    while (rows_ < columns_) extend();
    for (int j = 0; j < columns_; ++j) {
      auto v = D_.col(j).segment(j, rows_ - j);
      const double norm = v.norm();
      if (norm == 0.0) continue;
      const double diagonal = v[0] > 0.0 ? -norm : norm;
      v[0] -= diagonal;
      const double scale = 1.0 / (diagonal * v[0]);
      for (int k = j + 1; k < columns_; ++k) {
        auto w = D_.col(k).segment(j, rows_ - j);
        w += (scale * v.dot(w)) * v;
      }
      v.setZero();
      v[0] = diagonal;
    }
    rows_ = columns_;
  }

 private:
  Eigen::Matrix<double, kMaxRows, kMaxColumns> D_ =
      Eigen::Matrix<double, kMaxRows, kMaxColumns>::Zero();
  int rows_ = 0, columns_;
};

}  // namespace gyrotwin
