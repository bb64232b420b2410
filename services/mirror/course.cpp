#include "services/mirror/course.hpp"

#include <algorithm>
#include <cmath>

#include "services/mirror/calm_damping.hpp"
#include "services/model/dynamics.hpp"
#include "services/model/forces.hpp"

namespace gyrotwin {

namespace {

constexpr double kSteps[] = {4e-3, 2e-3, 1e-3, 5e-4};  // [s]
constexpr double kFineStep = 1.25e-4;                  // [s]
constexpr double kTolerance = 5e-3;                    // [rad]
constexpr double kCheck = 0.5;                         // [s]
constexpr double kBlows[] = {5e-3, 2e-2, 5e-2};        // of the push, e-fold [s]

}  // namespace

Course::Course(const Rig& rig, double horizon_s, double step_s)
    : rig_(rig),
      machine_(rig.build_machine()),
      law_(make_law(rig)),
      horizon_(horizon_s),
      step_(step_s),
      friction_(machine_.disc_friction.coulomb),
      lightness_(lightness(machine_, rig.initial_state(machine_))),
      safe_stop_(rig, machine_) {}

void Course::begin(const Outset& outset) noexcept {
  at_ = outset;
  safe_stop_.begin(outset.stopped_from);
  machine_.disc_friction.coulomb = std::max(0.0, friction_ + outset.disc_friction);
  time_ = 0.0;
  over_ = false;
  outcome_ = {};
  outcome_.gimbal_margin = machine_.gimbal_margin(at_.state);
  look();
}

model::Input Course::input(const model::State& state, double t) const noexcept {
  model::Input input;
  if (!at_.lawful) {
    input = safe_stop_.input(state);
  } else if (law_) {
    input.drive = law_->torque(machine_.observe(state), at_.memory);
  }
  input.drive_strength = at_.drive_strength;
  const Eigen::Vector2d moment = at_.lasting_moment + std::exp(-t / at_.fade_s) * at_.fading_moment;
  input.moment.head<2>() = moment;
  return input;
}

/// Its memory changes slowly, if at all: Euler's method will do.
void Course::step_memory() noexcept {
  if (!at_.lawful || !law_) return;
  const model::Observation seen = machine_.observe(at_.state);
  const DriveTorques wanted = law_->torque(seen, at_.memory);
  const DriveTorques given = within_limits(machine_, seen, wanted);
  if (given != wanted && outcome_.saturated_at < 0.0) outcome_.saturated_at = time_;
  if (law_->states() > 0) at_.memory += step_ * law_->rates(seen, at_.memory, wanted, given);
}

/// What is to be told of the present state.
void Course::look() noexcept {
  outcome_.tilt = machine_.tilt(at_.state);
  outcome_.gimbal_margin = std::min(outcome_.gimbal_margin, machine_.gimbal_margin(at_.state));
  if (outcome_.tilt > outcome_.peak_tilt) {
    outcome_.peak_tilt = outcome_.tilt;
    outcome_.peak_at = time_;
  }
  if (outcome_.tilt > rig_.safety.fall_tilt_rad) outcome_.fell_at = time_;
  over_ = outcome_.falls() || time_ >= horizon_ - 0.5 * step_;
}

/// Steps bear no drive that holds hard in its safe stop.
void Course::calm_down(const model::Motion& motion, const model::State& state,
                       const model::Input& input, model::Coordinates& acceleration) const noexcept {
  if (at_.lawful || rig_.safety.drive == SafeStopDrive::kZeroTorque) return;
  const bool brake = rig_.safety.drive == SafeStopDrive::kBrake;
  for (std::size_t i = 0; i < machine_.drives.size(); ++i) {
    const model::Drive& drive = machine_.drives[i];
    if (brake && drive.motor) continue;  // its brake is soft
    const double rate = model::rate_of(machine_, motion, drive, state);
    const double torque = drive.torque(input.mode, input.drive[i], rate);
    const double slip = brake ? rate : input.drive[i] / rig_.safety.gain;
    acceleration[drive.coordinate] *= calm_share(lightness_[i], torque, slip, step_);
  }
}

bool Course::advance() noexcept {
  if (over_) return false;
  const double h = step_;
  const auto slope = [this](const model::State& at, double t) {
    model::State k;
    k.q = at.v;
    const model::Input acting = input(at, t);
    model::Motion motion;
    k.v = model::accelerate(machine_, at, acting, {}, motion);
    calm_down(motion, at, acting, k.v);
    return k;
  };
  const auto moved = [this](const model::State& k, double dt) {
    model::State next = at_.state;
    next.q += dt * k.q;
    next.v += dt * k.v;
    return next;
  };
  const model::State k1 = slope(at_.state, time_);
  const model::State k2 = slope(moved(k1, 0.5 * h), time_ + 0.5 * h);
  const model::State k3 = slope(moved(k2, 0.5 * h), time_ + 0.5 * h);
  const model::State k4 = slope(moved(k3, h), time_ + h);
  step_memory();
  at_.state.q += h / 6.0 * (k1.q + 2.0 * k2.q + 2.0 * k3.q + k4.q);
  at_.state.v += h / 6.0 * (k1.v + 2.0 * k2.v + 2.0 * k3.v + k4.v);
  time_ += h;
  // Only a structure on its side has no solution.
  if (!at_.state.finite()) {
    outcome_.fell_at = time_;
    over_ = true;
    return false;
  }
  look();
  return !over_;
}

double coarsest_step(const Rig& rig) {
  const model::Machine machine = rig.build_machine();
  Outset outset;
  outset.state = rig.initial_state(machine);
  const std::unique_ptr<Law> law = make_law(rig);
  if (law) outset.memory = law->start(machine.observe(outset.state));

  constexpr int kLooks = static_cast<int>(kCheck / kSteps[0]);
  using Tilts = std::array<double, kLooks>;
  const auto run = [&](double blow, double step) {
    outset.fade_s = blow;
    outset.fading_moment.x() = rig.reference_impulse_nms / blow;
    Course course(rig, kCheck, step);
    course.begin(outset);
    Tilts tilts{};
    for (double& tilt : tilts) {
      for (int i = 0; i < std::lround(kSteps[0] / step); ++i) course.advance();
      tilt = course.outcome().tilt;
    }
    return tilts;
  };
  const double* step = std::begin(kSteps);
  for (const double blow : kBlows) {
    const Tilts fine = run(blow, kFineStep);
    const auto close = [&](double candidate) {
      const Tilts coarse = run(blow, candidate);
      double error = 0.0;
      for (int i = 0; i < kLooks; ++i) error = std::max(error, std::abs(coarse[i] - fine[i]));
      return error <= kTolerance;
    };
    while (step + 1 < std::end(kSteps) && !close(*step)) ++step;
  }
  return *step;
}

}  // namespace gyrotwin
