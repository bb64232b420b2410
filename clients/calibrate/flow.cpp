#include "clients/calibrate/flow.hpp"

#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <optional>
#include <string>

#include "services/integrator/plant.hpp"
#include "services/model/linearise.hpp"
#include "services/runtime/error.hpp"

namespace gyrotwin::calibration {

namespace {

constexpr long kMaxSteps = 100'000;  // of one call
constexpr double kRotorStep = 1e-2;  // of a rotor's speed, for differences [rad/s]

void require(bool ok, const char* what) {
  if (!ok) throw Error(std::string("SUNDIALS: ") + what + " failed");
}

// SUNDIALS would print to stderr; the return code says enough.
void ignore_message(int, const char*, const char*, char*, void*) {}

Eigen::VectorXd rates(const model::Machine& machine, const Eigen::VectorXd& y,
                      const model::Input& input, const model::RotorSpeeds& held) {
  Eigen::VectorXd dy(y.size());
  packed_rates(machine, unpack(machine, y.data(), held), input, dy.data());
  return dy;
}

}  // namespace

bool alike(const model::Input& a, const model::Input& b) {
  const auto same_mass = [](const model::PointMass& m, const model::PointMass& n) {
    return m.mass == n.mass && m.position == n.position;
  };
  return a.mode == b.mode && a.drive == b.drive && a.force == b.force && a.moment == b.moment &&
         a.ground_acceleration == b.ground_acceleration && a.yaw_rate == b.yaw_rate &&
         std::ranges::equal(a.added, b.added, same_mass) && a.drive_strength == b.drive_strength &&
         a.rotor_powered == b.rotor_powered && a.rotor_brake == b.rotor_brake;
}

RateDerivatives rate_derivatives(const Neighbourhood& around, const Eigen::VectorXd& y,
                                 const model::Input& input, const model::RotorSpeeds& held) {
  const model::Machine& machine = around.machine;
  const int n = machine.coordinates();
  const auto size = y.size();
  RateDerivatives d{Eigen::MatrixXd::Zero(size, size),
                    Eigen::MatrixXd(size, static_cast<Eigen::Index>(around.pairs.size()))};
  const model::Linearisation about =
      model::linearise(machine, unpack(machine, y.data(), held), input);
  d.by_state.block(0, n, n, n).setIdentity();
  d.by_state.block(n, 0, n, n) = about.dq.topLeftCorner(n, n);
  d.by_state.block(n, n, n, n) = about.dv.topLeftCorner(n, n);
  Eigen::VectorXd moved = y;
  for (Eigen::Index j = 2 * n; j < size; ++j) {
    moved[j] = y[j] + kRotorStep;
    const Eigen::VectorXd up = rates(machine, moved, input, held);
    moved[j] = y[j] - kRotorStep;
    d.by_state.col(j) = (up - rates(machine, moved, input, held)) / (2.0 * kRotorStep);
    moved[j] = y[j];
  }
  for (std::size_t i = 0; i < around.pairs.size(); ++i) {
    const auto& [up, down, span] = around.pairs[i];
    d.by_parameter.col(static_cast<Eigen::Index>(i)) =
        (rates(up, y, input, held) - rates(down, y, input, held)) / span;
  }
  return d;
}

struct Flow::Solver {
  const Neighbourhood& around;
  model::RotorSpeeds held;
  Eigen::Index size, columns;
  std::optional<model::Input> input;
  double time = 0.0;  // since the method started anew
  Eigen::VectorXd y;
  Eigen::MatrixXd S;

  // Derivatives where they were asked for last: the corrector asks again at the same place.
  Eigen::VectorXd place;
  RateDerivatives derivatives;

  SUNContext context = nullptr;
  N_Vector state = nullptr;
  N_Vector* sensitivities = nullptr;
  SUNNonlinearSolver corrector = nullptr, sensitivity_corrector = nullptr;
  void* memory = nullptr;

  Solver(const Neighbourhood& a, const model::RotorSpeeds& h, const Eigen::VectorXd& start)
      : around(a), held(h), size(start.size()), columns(0), y(start) {}
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  ~Solver() {
    if (memory) CVodeFree(&memory);
    if (corrector) SUNNonlinSolFree(corrector);
    if (sensitivity_corrector) SUNNonlinSolFree(sensitivity_corrector);
    if (sensitivities) N_VDestroyVectorArray(sensitivities, static_cast<int>(columns));
    if (state) N_VDestroy(state);
    if (context) SUNContext_Free(&context);
  }

  static int right_hand_side(realtype, N_Vector at, N_Vector rate, void* context) {
    const auto& self = *static_cast<Solver*>(context);
    const model::Machine& machine = self.around.machine;
    packed_rates(machine, unpack(machine, N_VGetArrayPointer(at), self.held), *self.input,
                 N_VGetArrayPointer(rate));
    return 0;
  }

  static int sensitivity_rates(int count, realtype, N_Vector at, N_Vector, N_Vector* s,
                               N_Vector* rate, void* context, N_Vector, N_Vector) {
    auto& self = *static_cast<Solver*>(context);
    const Eigen::Map<const Eigen::VectorXd> here(N_VGetArrayPointer(at), self.size);
    if (self.place.size() != self.size || self.place != here) {
      self.place = here;
      self.derivatives = rate_derivatives(self.around, self.place, *self.input, self.held);
    }
    for (int i = 0; i < count; ++i) {
      const Eigen::Map<const Eigen::VectorXd> from(N_VGetArrayPointer(s[i]), self.size);
      Eigen::Map<Eigen::VectorXd> to(N_VGetArrayPointer(rate[i]), self.size);
      to.noalias() = self.derivatives.by_state * from;
      if (i >= self.size) to += self.derivatives.by_parameter.col(i - self.size);
    }
    return 0;
  }

  void write() {
    std::copy_n(y.data(), size, N_VGetArrayPointer(state));
    for (Eigen::Index i = 0; i < columns; ++i) {
      std::copy_n(S.col(i).data(), size, N_VGetArrayPointer(sensitivities[i]));
    }
  }

  void read() {
    std::copy_n(N_VGetArrayPointer(state), size, y.data());
    for (Eigen::Index i = 0; i < columns; ++i) {
      std::copy_n(N_VGetArrayPointer(sensitivities[i]), size, S.col(i).data());
    }
  }

  void set_up();
  void set_up_sensitivities();
};

void Flow::Solver::set_up() {
  require(SUNContext_Create(nullptr, &context) == 0, "SUNContext_Create");
  state = N_VNew_Serial(size, context);
  require(state != nullptr, "N_VNew_Serial");
  if (columns > 0) sensitivities = N_VCloneVectorArray(static_cast<int>(columns), state);
  write();
  memory = CVodeCreate(CV_ADAMS, context);
  require(memory != nullptr, "CVodeCreate");
  require(CVodeSetErrHandlerFn(memory, ignore_message, nullptr) == CV_SUCCESS, "error handler");
  require(CVodeInit(memory, right_hand_side, 0.0, state) == CV_SUCCESS, "CVodeInit");
  require(CVodeSetUserData(memory, this) == CV_SUCCESS, "CVodeSetUserData");
  require(CVodeSStolerances(memory, kRelative, kAbsolute) == CV_SUCCESS, "tolerances");
  require(CVodeSetMaxNumSteps(memory, kMaxSteps) == CV_SUCCESS, "step limit");
  corrector = SUNNonlinSol_FixedPoint(state, 0, context);
  require(corrector && CVodeSetNonlinearSolver(memory, corrector) == CV_SUCCESS, "fixed point");
  if (columns > 0) set_up_sensitivities();
}

void Flow::Solver::set_up_sensitivities() {
  const int count = static_cast<int>(columns);
  require(
      CVodeSensInit(memory, count, CV_STAGGERED, sensitivity_rates, sensitivities) == CV_SUCCESS,
      "CVodeSensInit");
  require(CVodeSensEEtolerances(memory) == CV_SUCCESS, "tolerances of sensitivities");
  require(CVodeSetSensErrCon(memory, SUNFALSE) == CV_SUCCESS, "error control");
  sensitivity_corrector = SUNNonlinSol_FixedPointSens(count, state, 0, context);
  require(sensitivity_corrector &&
              CVodeSetNonlinearSolverSensStg(memory, sensitivity_corrector) == CV_SUCCESS,
          "fixed point of sensitivities");
}

Flow::Flow(const Neighbourhood& around, const model::RotorSpeeds& held,
           const Eigen::VectorXd& start, bool derivatives)
    : solver_(std::make_unique<Solver>(around, held, start)) {
  Solver& s = *solver_;
  if (derivatives) {
    s.columns = s.size + static_cast<Eigen::Index>(around.pairs.size());
    s.S = Eigen::MatrixXd::Identity(s.size, s.columns);
  }
  s.set_up();
}

Flow::~Flow() = default;

bool Flow::advance(const model::Input& input, double dt, double lasts) {
  Solver& s = *solver_;
  bool ok = true;
  if (!s.input || !alike(*s.input, input)) {
    s.input = input;
    s.place.resize(0);
    s.time = 0.0;
    s.write();
    ok = CVodeReInit(s.memory, 0.0, s.state) == CV_SUCCESS &&
         (s.columns == 0 ||
          CVodeSensReInit(s.memory, CV_STAGGERED, s.sensitivities) == CV_SUCCESS) &&
         CVodeSetStopTime(s.memory, std::max(lasts, dt)) == CV_SUCCESS;
  }
  realtype t = s.time;
  s.time += dt;
  ok = ok && CVode(s.memory, s.time, s.state, &t, CV_NORMAL) >= 0;
  if (ok && s.columns > 0) ok = CVodeGetSens(s.memory, &t, s.sensitivities) == CV_SUCCESS;
  if (ok) s.read();
  return ok && s.y.allFinite() && s.S.allFinite();
}

const Eigen::VectorXd& Flow::state() const { return solver_->y; }
const Eigen::MatrixXd& Flow::sensitivity() const { return solver_->S; }
model::State Flow::unpacked() const {
  return unpack(solver_->around.machine, solver_->y.data(), solver_->held);
}

}  // namespace gyrotwin::calibration
