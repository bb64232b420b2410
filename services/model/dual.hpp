// Dual numbers: a value and its derivative along one direction, carried through every operation.
// Exact but for rounding; comparisons look at the value alone.
// Source: W. K. Clifford, 1873; A. Griewank and A. Walther, Evaluating Derivatives, 2008, ch. 3.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace gyrotwin::model {

struct Dual {
  double value = 0.0;
  double slope = 0.0;

  constexpr Dual() = default;
  // A plain number is a constant, of slope 0: implicit, as Eigen needs it.
  constexpr Dual(double v, double s = 0.0)  // NOLINT(google-explicit-constructor)
      : value(v), slope(s) {}

  constexpr Dual& operator+=(const Dual& b) { return *this = {value + b.value, slope + b.slope}; }
  constexpr Dual& operator-=(const Dual& b) { return *this = {value - b.value, slope - b.slope}; }
  constexpr Dual& operator*=(const Dual& b) {
    return *this = {value * b.value, slope * b.value + value * b.slope};
  }
  constexpr Dual& operator/=(const Dual& b) {
    const double quotient = value / b.value;
    return *this = {quotient, (slope - quotient * b.slope) / b.value};
  }

  constexpr friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  constexpr friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  constexpr friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  constexpr friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  constexpr friend Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }

  constexpr friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  constexpr friend bool operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }
  constexpr friend bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  constexpr friend bool operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  constexpr friend bool operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  constexpr friend bool operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }

  friend Dual tanh(const Dual& a) {
    const double t = std::tanh(a.value);
    return {t, a.slope * (1.0 - t * t)};
  }
  friend Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    return {root, a.slope / (2.0 * root)};
  }
  friend Dual abs(const Dual& a) { return a.value < 0.0 ? -a : a; }
};

}  // namespace gyrotwin::model

namespace Eigen {

template <>
struct NumTraits<gyrotwin::model::Dual> : GenericNumTraits<double> {
  using Real = gyrotwin::model::Dual;
  using NonInteger = gyrotwin::model::Dual;
  using Nested = gyrotwin::model::Dual;
  enum { ReadCost = 2, AddCost = 2, MulCost = 4 };
};

template <class Operation>
struct ScalarBinaryOpTraits<gyrotwin::model::Dual, double, Operation> {
  using ReturnType = gyrotwin::model::Dual;
};

template <class Operation>
struct ScalarBinaryOpTraits<double, gyrotwin::model::Dual, Operation> {
  using ReturnType = gyrotwin::model::Dual;
};

}  // namespace Eigen
