// One ordinary differential equation, stepped by SUNDIALS' explicit Runge-Kutta methods.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

namespace gyrotwin {

/// y' = rates(t, y).
class Ode {
 public:
  static constexpr int kMaxSize = 24;  ///< a machine with its rotors and a law's memory: up to 18

  virtual ~Ode() = default;
  virtual int size() const noexcept = 0;
  /// Time [s], size() entries in, size() entries out.
  virtual void rates(double t, const double* y, double* dy) noexcept = 0;
};

/// How to step: a number of equal steps, bounded and repeatable, or as many as the tolerance asks.
struct StepPolicy {
  bool adaptive = false;
  int substeps = 4;     ///< fixed: steps per call of advance()
  double rtol = 1e-12;  ///< adaptive: relative tolerance per entry
  double atol = 1e-14;  ///< adaptive: absolute tolerance per entry
};

/// Advances one Ode by Dormand and Prince's 5(4) pair, the 5th-order result kept. At tolerances of
/// 1e-12 pairs of higher order (Verner 6(5), Fehlberg 8(7)) were no cheaper or, across the kinks of
/// contact and stops, wrong by more than they said. After construction: no allocation, no
/// exception.
class Stepper {
 public:
  /// @param ode outlives the stepper
  /// @throws Error when SUNDIALS cannot be set up
  Stepper(Ode& ode, const StepPolicy& policy);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Takes `y` from t0 to t1 [s] with the right-hand side smooth in between. @return whether it got
  /// there; if not, `y` is where it failed.
  bool advance(double t0, double t1, std::span<double> y) noexcept;

  /// Right-hand sides of the last advance().
  std::int64_t evaluations() const noexcept;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace gyrotwin
