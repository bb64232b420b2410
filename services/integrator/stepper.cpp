#include "services/integrator/stepper.hpp"

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr long kMaxSteps = 1'000'000;
// A jump of the right-hand side is met by making the step a billionth: not in the usual 7 tries.
constexpr int kMaxErrorTestFailures = 100;

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

struct Stepper::Solver {
  SUNContext context = nullptr;
  N_Vector y = nullptr;
  void* memory = nullptr;
  StepPolicy policy;
  long evaluations_before = 0;
  std::int64_t evaluations = 0;

  ~Solver() {
    if (memory) ERKStepFree(&memory);
    if (y) N_VDestroy(y);
    if (context) SUNContext_Free(&context);
  }
};

Stepper::Stepper(Ode& ode, const StepPolicy& policy) : solver_(std::make_unique<Solver>()) {
  Solver& s = *solver_;
  s.policy = policy;
  if (ode.size() > Ode::kMaxSize) {
    throw Error("an equation has " + std::to_string(ode.size()) + " entries; at most " +
                std::to_string(Ode::kMaxSize) + ": raise Ode::kMaxSize");
  }
  require(SUNContext_Create(nullptr, &s.context) == 0, "SUNContext_Create");
  s.y = N_VNew_Serial(ode.size(), s.context);
  require(s.y != nullptr, "N_VNew_Serial");
  s.y->ops->nvlinearcombination = linear_combination;
  N_VConst(0.0, s.y);
  s.memory = ERKStepCreate(right_hand_side, 0.0, s.y, s.context);
  require(s.memory != nullptr, "ERKStepCreate");
  require(ERKStepSetErrHandlerFn(s.memory, ignore_message, nullptr) == ARK_SUCCESS,
          "error handler");
  require(ERKStepSetUserData(s.memory, &ode) == ARK_SUCCESS, "ERKStepSetUserData");
  require(ERKStepSetTableNum(s.memory, ARKODE_DORMAND_PRINCE_7_4_5) == ARK_SUCCESS,
          "ERKStepSetTableNum");
  if (policy.adaptive) {
    require(ERKStepSStolerances(s.memory, policy.rtol, policy.atol) == ARK_SUCCESS, "tolerances");
    require(ERKStepSetMaxNumSteps(s.memory, kMaxSteps) == ARK_SUCCESS, "step limit");
    require(ERKStepSetMaxErrTestFails(s.memory, kMaxErrorTestFailures) == ARK_SUCCESS,
            "limit of error test failures");
  }
}

Stepper::~Stepper() = default;

bool Stepper::advance(double t0, double t1, std::span<double> y) noexcept {
  Solver& s = *solver_;
  std::copy(y.begin(), y.end(), N_VGetArrayPointer(s.y));
  // The input may have jumped at t0: nothing of the step before is reused.
  bool ok = ERKStepReset(s.memory, t0, s.y) == ARK_SUCCESS;
  realtype t = t0;
  if (s.policy.adaptive) {
    ok = ok && ERKStepSetStopTime(s.memory, t1) == ARK_SUCCESS &&
         ERKStepEvolve(s.memory, t1, s.y, &t, ARK_NORMAL) >= 0;
  } else {
    ok = ok && ERKStepSetFixedStep(s.memory, (t1 - t0) / s.policy.substeps) == ARK_SUCCESS;
    for (int i = 0; ok && i < s.policy.substeps; ++i) {
      ok = ERKStepEvolve(s.memory, t1, s.y, &t, ARK_ONE_STEP) >= 0;
    }
  }
  std::copy_n(N_VGetArrayPointer(s.y), y.size(), y.begin());
  long evaluations = 0;
  ERKStepGetNumRhsEvals(s.memory, &evaluations);
  s.evaluations = evaluations - s.evaluations_before;
  s.evaluations_before = evaluations;
  return ok;
}

std::int64_t Stepper::evaluations() const noexcept { return solver_->evaluations; }

}  // namespace gyrotwin
