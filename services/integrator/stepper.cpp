#include "services/integrator/stepper.hpp"

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <array>
#include <string>

#include "services/integrator/kutta.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr double kAbsolute = 0.01 * StepPolicy::kExact;  // for entries around 0
constexpr long kMaxSteps = 1'000'000;
// A jump of the right-hand side is met by making the step a billionth: not in the usual 7 tries.
constexpr int kMaxErrorTestFailures = 100;
constexpr int kQuickStride = 4;  // a quick stepper each for up to 4, 8, 12 ... entries

int right_hand_side(realtype t, N_Vector y, N_Vector dy, void* context) {
  static_cast<Ode*>(context)->rates(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
  return 0;
}

// SUNDIALS would print to stderr; the return code says enough.
void ignore_message(int, const char*, const char*, char*, void*) {}

/// z = sum c_i X_i, which is most of what a Runge-Kutta step does beside the right-hand sides, for
/// a handful of entries. Any X_i may be z.
int linear_combination(int count, realtype* c, N_Vector* X, N_Vector z) {
  const auto size = static_cast<std::size_t>(N_VGetLength_Serial(z));
  std::array<double, Ode::kMaxSize> sum;
  const double* x = N_VGetArrayPointer_Serial(X[0]);
  for (std::size_t j = 0; j < size; ++j) sum[j] = c[0] * x[j];
  for (int i = 1; i < count; ++i) {
    x = N_VGetArrayPointer_Serial(X[i]);
    for (std::size_t j = 0; j < size; ++j) sum[j] += c[i] * x[j];
  }
  std::copy_n(sum.begin(), size, N_VGetArrayPointer_Serial(z));
  return 0;
}

void require(bool ok, const char* what) {
  if (!ok) throw Error(std::string("SUNDIALS: ") + what + " failed");
}

}  // namespace

class Stepper::Solver {
 public:
  virtual ~Solver() = default;
  virtual bool advance(double t0, double t1, std::span<double> y) noexcept = 0;
  virtual std::int64_t evaluations() const noexcept = 0;
};

class Stepper::Sundials : public Stepper::Solver {
 public:
  // Delegates, so that what throws half-way is destroyed.
  Sundials(Ode& ode, const StepPolicy& policy) : Sundials(policy) {
    require(SUNContext_Create(nullptr, &context_) == 0, "SUNContext_Create");
    y_ = N_VNew_Serial(ode.size(), context_);
    require(y_ != nullptr, "N_VNew_Serial");
    y_->ops->nvlinearcombination = linear_combination;
    N_VConst(0.0, y_);
    memory_ = ERKStepCreate(right_hand_side, 0.0, y_, context_);
    require(memory_ != nullptr, "ERKStepCreate");
    require(ERKStepSetErrHandlerFn(memory_, ignore_message, nullptr) == ARK_SUCCESS,
            "error handler");
    require(ERKStepSetUserData(memory_, &ode) == ARK_SUCCESS, "ERKStepSetUserData");
    require(ERKStepSetTableNum(memory_, ARKODE_DORMAND_PRINCE_7_4_5) == ARK_SUCCESS,
            "ERKStepSetTableNum");
    if (adaptive()) {
      require(ERKStepSStolerances(memory_, StepPolicy::kExact, kAbsolute) == ARK_SUCCESS,
              "tolerances");
      require(ERKStepSetMaxNumSteps(memory_, kMaxSteps) == ARK_SUCCESS, "step limit");
      require(ERKStepSetMaxErrTestFails(memory_, kMaxErrorTestFailures) == ARK_SUCCESS,
              "limit of error test failures");
    }
  }
  ~Sundials() override {
    if (memory_) ERKStepFree(&memory_);
    if (y_) N_VDestroy(y_);
    if (context_) SUNContext_Free(&context_);
  }
  Sundials(const Sundials&) = delete;
  Sundials& operator=(const Sundials&) = delete;

  bool advance(double t0, double t1, std::span<double> y) noexcept override {
    std::copy(y.begin(), y.end(), N_VGetArrayPointer(y_));
    // The input may have jumped at t0: nothing of the step before is reused.
    bool ok = ERKStepReset(memory_, t0, y_) == ARK_SUCCESS;
    realtype t = t0;
    if (adaptive()) {
      ok = ok && ERKStepSetStopTime(memory_, t1) == ARK_SUCCESS &&
           ERKStepEvolve(memory_, t1, y_, &t, ARK_NORMAL) >= 0;
    } else {
      ok = ok && ERKStepSetFixedStep(memory_, (t1 - t0) / policy_.substeps) == ARK_SUCCESS;
      for (int i = 0; ok && i < policy_.substeps; ++i) {
        ok = ERKStepEvolve(memory_, t1, y_, &t, ARK_ONE_STEP) >= 0;
      }
    }
    std::copy_n(N_VGetArrayPointer(y_), y.size(), y.begin());
    long evaluations = 0;
    ERKStepGetNumRhsEvals(memory_, &evaluations);
    evaluations_ = evaluations - evaluations_before_;
    evaluations_before_ = evaluations;
    return ok;
  }
  std::int64_t evaluations() const noexcept override { return evaluations_; }

 private:
  explicit Sundials(const StepPolicy& policy) : policy_(policy) {}
  bool adaptive() const { return policy_.kind == StepPolicy::Kind::kAdaptive; }

  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  void* memory_ = nullptr;
  StepPolicy policy_;
  long evaluations_before_ = 0;
  std::int64_t evaluations_ = 0;
};

template <int n>
class Stepper::Quick : public Stepper::Solver {
 public:
  explicit Quick(Ode& ode) : pair_(ode, StepPolicy::kCoarse) {}
  bool advance(double t0, double t1, std::span<double> y) noexcept override {
    return pair_.advance(t0, t1, y.data());
  }
  std::int64_t evaluations() const noexcept override { return pair_.evaluations(); }

 private:
  Kutta<n> pair_;
};

/// For the smallest n that holds the equation.
template <int n>
std::unique_ptr<Stepper::Solver> Stepper::quick(Ode& ode) {
  if constexpr (n < Ode::kMaxSize) {
    if (ode.size() > n) return quick<n + kQuickStride>(ode);
  }
  return std::make_unique<Quick<n>>(ode);
}

Stepper::Stepper(Ode& ode, const StepPolicy& policy) {
  if (ode.size() > Ode::kMaxSize) {
    throw Error("an equation has " + std::to_string(ode.size()) + " entries; at most " +
                std::to_string(Ode::kMaxSize) + ": raise Ode::kMaxSize");
  }
  if (policy.kind == StepPolicy::Kind::kQuick) {
    solver_ = quick<kQuickStride>(ode);
  } else {
    solver_ = std::make_unique<Sundials>(ode, policy);
  }
}

Stepper::~Stepper() = default;

bool Stepper::advance(double t0, double t1, std::span<double> y) noexcept {
  return solver_->advance(t0, t1, y);
}

std::int64_t Stepper::evaluations() const noexcept { return solver_->evaluations(); }

}  // namespace gyrotwin
