#include "clients/analyze/polynomial.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace gyrotwin {

namespace {

// Of a row's largest possible rounding: below it an entry is zero.
constexpr double kRounding = 1e-12;
// Instead of a zero at a row's beginning, as a share of the row.
constexpr double kEpsilon = 1e-9;

double largest(const std::vector<double>& row) {
  double most = 0.0;
  for (const double x : row) most = std::max(most, std::abs(x));
  return most;
}

/// The slope of the even or odd polynomial that a row of degree `power` stands for.
std::vector<double> slope_of(const std::vector<double>& row, int power) {
  std::vector<double> slope(row.size(), 0.0);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int here = power - 2 * static_cast<int>(i);
    slope[i] = here > 0 ? here * row[i] : 0.0;
  }
  return slope;
}

}  // namespace

Polynomial polynomial_of(const Eigen::VectorXcd& roots) {
  std::vector<std::complex<double>> product{1.0};
  for (const std::complex<double>& root : roots) {
    product.push_back(0.0);
    for (std::size_t i = product.size() - 1; i > 0; --i) product[i] -= root * product[i - 1];
  }
  Polynomial real;
  for (const auto& coefficient : product) real.push_back(coefficient.real());
  return real;
}

Routh routh(const Polynomial& polynomial) {
  const int degree = static_cast<int>(polynomial.size()) - 1;
  const std::size_t width = static_cast<std::size_t>(degree) / 2 + 1;
  Routh scheme;
  scheme.rows.assign(2, std::vector<double>(width, 0.0));
  for (std::size_t i = 0; i < polynomial.size(); ++i) scheme.rows[i % 2][i / 2] = polynomial[i];

  for (int row = 1; row <= degree; ++row) {
    if (row > 1) {
      const std::vector<double>& above = scheme.rows[row - 1];
      const std::vector<double>& top = scheme.rows[row - 2];
      std::vector<double> next(width, 0.0);
      for (std::size_t i = 0; i + 1 < width; ++i) {
        const double straight = top[i + 1];
        const double crossed = top[0] * above[i + 1] / above[0];
        const double difference = straight - crossed;
        const double rounding = kRounding * (std::abs(straight) + std::abs(crossed));
        next[i] = std::abs(difference) <= rounding ? 0.0 : difference;
      }
      scheme.rows.push_back(next);
    }
    std::vector<double>& now = scheme.rows[row];
    if (largest(now) == 0.0) {
      now = slope_of(scheme.rows[row - 1], degree - row + 1);
      scheme.opposite_roots = true;
    }
    if (now[0] == 0.0) now[0] = kEpsilon * std::max(largest(now), kEpsilon);
  }
  for (int row = 1; row <= degree; ++row) {
    if (scheme.rows[row][0] * scheme.rows[row - 1][0] < 0.0) ++scheme.unstable;
  }
  return scheme;
}

std::string text_of(const Polynomial& polynomial) {
  std::string text;
  const int degree = static_cast<int>(polynomial.size()) - 1;
  for (int i = 0; i <= degree; ++i) {
    const double c = polynomial[static_cast<std::size_t>(i)];
    const int power = degree - i;
    if (c == 0.0 && power > 0) continue;
    const bool unit = std::abs(c) == 1.0 && power > 0;
    text += text.empty() ? (c < 0.0 ? "-" : "") : (c < 0.0 ? " - " : " + ");
    text += unit ? "" : fmt::format("{:.4g}", std::abs(c)) + (power > 0 ? " " : "");
    if (power > 0) text += power == 1 ? "s" : "s^" + std::to_string(power);
  }
  return text;
}

}  // namespace gyrotwin
