// A Runge-Kutta pair of low order with control of its error, for many runs whose last digits nobody
// reads. Source: W. Kutta, Beitrag zur naeherungsweisen Integration totaler
// Differentialgleichungen, Zeitschrift fuer Mathematik und Physik 46 (1901), 435-453: the formula
// of third order whose weights are Simpson's.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "services/integrator/stepper.hpp"

namespace gyrotwin {

/// Steps an Ode of at most n entries: the compiler writes out the sums of few. Each call begins
/// with the step that suited the end of the one before. No allocation, no exception.
///
/// Its three stages hold a formula of second order too, the midpoint rule. Pairs whose last stage
/// is the next step's first (Bogacki-Shampine) take one more a call, of no use where the input then
/// jumps; and most ticks are one step.
template <int n>
class Kutta {
 public:
  /// @param ode outlives it
  /// @param tolerance what a step may be off by in each entry y, as estimated: tolerance (1 + |y|)
  Kutta(Ode& ode, double tolerance) : ode_(ode), tolerance_(tolerance) {}

  /// As Stepper::advance().
  bool advance(double t0, double t1, double* state) noexcept {
    const int size = ode_.size();
    std::copy_n(state, size, y_.data());
    evaluations_ = 0;
    rates(t0, y_, k1_);
    double t = t0;
    for (int attempts = 0; t < t1 && attempts < kMostAttempts; ++attempts) {
      const double left = t1 - t;
      const bool last = step_ >= left;
      // Not a long step and a tiny rest.
      const double h = last ? left : std::min(step_, 0.5 * left);
      if (t + h == t) break;
      const double error = attempt(t, h);
      // The estimate is a share of a second-order result's error: it goes with the step's cube.
      const double better = h * std::clamp(kSafety / std::cbrt(error), 0.2, 5.0);
      if (!(error <= 1.0)) {
        step_ = error > 1.0 ? better : 0.2 * h;
        continue;
      }
      // What the call's end cut short says nothing against the longer step.
      step_ = last && better >= h ? std::max(step_, better) : better;
      t = last ? t1 : t + h;
      y_ = next_;
      if (!last) rates(t, y_, k1_);
    }
    if (t != t1) step_ = HUGE_VAL;
    std::copy_n(y_.data(), size, state);
    return t == t1;
  }

  /// Right-hand sides of the last advance().
  std::int64_t evaluations() const noexcept { return evaluations_; }

 private:
  // Rates that jump with the state would have ever smaller steps go to and fro.
  static constexpr int kMostAttempts = 100'000;
  static constexpr double kSafety = 0.9;
  // Of the midpoint rule's error. With it the estimate is Bogacki and Shampine's, to leading order,
  // where y' = A y; of what is not linear or goes with t it is a quarter of theirs.
  static constexpr double kShare = 1.0 / 8.0;

  using Vector = Eigen::Array<double, n, 1>;

  void rates(double t, const Vector& y, Vector& k) noexcept {
    ode_.rates(t, y.data(), k.data());
    ++evaluations_;
  }

  /// From y_ and its rates k1_ to next_. @return the largest error of an entry in units of what it
  /// may have; may be NaN
  double attempt(double t, double h) noexcept {
    rates(t + 0.5 * h, y_ + 0.5 * h * k1_, k2_);
    rates(t + h, y_ + h * (2.0 * k2_ - k1_), k3_);
    next_ = y_ + h / 6.0 * (k1_ + 4.0 * k2_ + k3_);
    const Vector error = kShare * h / 6.0 * (k1_ - 2.0 * k2_ + k3_);
    // The last term is 0, or NaN where an entry is infinite and would be allowed to be off by that.
    const Vector allowed = tolerance_ + tolerance_ * next_.abs();
    return (error.abs() / allowed + (next_ - next_)).template maxCoeff<Eigen::PropagateNaN>();
  }

  Ode& ode_;
  double tolerance_;
  double step_ = HUGE_VAL;
  // Entries beyond the Ode's stay 0.
  Vector y_ = Vector::Zero(), next_ = Vector::Zero();
  Vector k1_ = Vector::Zero(), k2_ = Vector::Zero(), k3_ = Vector::Zero();
  std::int64_t evaluations_ = 0;
};

}  // namespace gyrotwin
