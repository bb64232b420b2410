// One ordinary differential equation, stepped by explicit Runge-Kutta methods.
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

/// How to step.
struct StepPolicy {
  enum class Kind : std::uint8_t {
    kFixed,     ///< Dormand-Prince 5(4), equal steps: bounded and repeatable, as live
    kAdaptive,  ///< the same, as fine as kExact asks
    kQuick,     ///< Kutta's third order, as coarse as kCoarse allows
  };
  static constexpr double kExact = 1e-12;  ///< of an entry y, in a step, as estimated: of |y|
  static constexpr double kCoarse = 2e-7;  ///< likewise: of 1 + |y|

  Kind kind = Kind::kFixed;
  int substeps = 4;  ///< fixed: steps per call of advance()
};

/// Advances one Ode. Fixed and adaptive are SUNDIALS'; Dormand and Prince's pair keeps the
/// 5th-order result. At 1e-12 pairs of higher order (Verner 6(5), Fehlberg 8(7)) were no cheaper
/// or, across the kinks of contact and stops, wrong by more than they said. Quick is our own:
/// SUNDIALS around a pair of third order took twice the time of ours for a machine whose right-hand
/// side is 0.15 us. After construction: no allocation, no exception.
class Stepper {
 public:
  /// @param ode outlives the stepper
  /// @throws Error when SUNDIALS cannot be set up
  Stepper(Ode& ode, const StepPolicy& policy);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Takes `y` from t0 to t1 [s] with the right-hand side smooth in between. Fixed and adaptive:
  /// the same arguments give the same bits; quick: the same calls in the same order do. @return
  /// whether it got there; if not, `y` is where it failed.
  bool advance(double t0, double t1, std::span<double> y) noexcept;

  /// Right-hand sides of the last advance().
  std::int64_t evaluations() const noexcept;

 private:
  class Solver;
  class Sundials;
  template <int n>
  class Quick;
  template <int n>
  static std::unique_ptr<Solver> quick(Ode& ode);

  std::unique_ptr<Solver> solver_;
};

}  // namespace gyrotwin
