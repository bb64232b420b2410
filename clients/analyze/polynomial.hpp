// Characteristic polynomials and what Routh's scheme says of them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace gyrotwin {

/// Coefficients, the highest power first.
using Polynomial = std::vector<double>;

/// The monic polynomial with these roots, which are real or come in conjugate pairs.
Polynomial polynomial_of(const Eigen::VectorXcd& roots);

/// Routh's scheme. As many roots lie in the right half plane as the first column changes its sign.
struct Routh {
  std::vector<std::vector<double>> rows;  ///< of s^n, s^(n-1), ..., s^0
  int unstable = 0;                       ///< roots with a positive real part
  /// A row came out as zero and stands as the slope of the row above: there are roots opposite to
  /// each other, such as pairs on the imaginary axis.
  bool opposite_roots = false;

  /// No root on the axis or right of it.
  bool stable() const { return unstable == 0 && !opposite_roots; }
};

/// @pre at least two coefficients, the first not zero
Routh routh(const Polynomial& polynomial);

/// "s^3 + 2 s^2 - 0.5": four digits each.
std::string text_of(const Polynomial& polynomial);

}  // namespace gyrotwin
