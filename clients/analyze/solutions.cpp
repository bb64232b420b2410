#include "clients/analyze/solutions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "clients/simulate/simulation.hpp"
#include "services/controller/branch.hpp"
#include "services/controller/gimbal_axes.hpp"
#include "services/integrator/stepper.hpp"

namespace gyrotwin {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSmall = std::numbers::pi / 180.0;  // a tilt that is nearly linear [rad]
constexpr int kPlaces = 300;                         // where two motions are compared

/// x' = F x + B a sin(w t), by its modes.
class LinearMotion {
 public:
  LinearMotion(const MatrixXd& F, const VectorXd& B, const VectorXd& start, double a, double w)
      : w_(w) {
    const Eigen::EigenSolver<MatrixXd> solver(F);
    modes_ = solver.eigenvectors();
    rates_ = solver.eigenvalues();
    const std::complex<double> i(0.0, 1.0);
    forced_ = a * (i * w * MatrixXd::Identity(F.rows(), F.cols()) - F)
                      .partialPivLu()
                      .solve(B.cast<std::complex<double>>());
    if (a == 0.0) forced_.setZero();
    shares_ = modes_.partialPivLu().solve((start - forced_.imag()).cast<std::complex<double>>());
  }
  VectorXd at(double t) const {
    const std::complex<double> turn = std::exp(std::complex<double>(0.0, w_ * t));
    const Eigen::VectorXcd grown = (rates_ * t).array().exp() * shares_.array();
    return (modes_ * grown).real() + (forced_ * turn).imag();
  }

 private:
  double w_;
  Eigen::MatrixXcd modes_;
  Eigen::VectorXcd rates_, forced_, shares_;
};

/// The same equation, for the stepper.
class LinearOde : public Ode {
 public:
  LinearOde(MatrixXd F, VectorXd B, double a, double w)
      : F_(std::move(F)), B_(std::move(B)), a_(a), w_(w) {}
  int size() const noexcept override { return static_cast<int>(F_.rows()); }
  void rates(double t, const double* y, double* dy) noexcept override {
    Eigen::Map<VectorXd>(dy, F_.rows()) =
        F_ * Eigen::Map<const VectorXd>(y, F_.rows()) + B_ * (a_ * std::sin(w_ * t));
  }

 private:
  MatrixXd F_;
  VectorXd B_;
  double a_, w_;
};

/// Two tilts over time, the one by formula.
class Matched {
 public:
  void note(double formula, double integrated) {
    formula_ = std::max(formula_, std::abs(formula));
    integrated_ = std::max(integrated_, std::abs(integrated));
    apart_ = std::max(apart_, std::abs(formula - integrated));
  }
  Comparison told(std::string key, std::string meaning) const {
    return {std::move(key), std::move(meaning), formula_, integrated_, apart_ / formula_, "rad"};
  }

 private:
  double formula_ = 0.0, integrated_ = 0.0, apart_ = 0.0;
};

/// Integrates x' = F x + B a sin(w t) beside a formula for x[0].
Comparison reduced(std::string key, std::string meaning, const MatrixXd& F, const VectorXd& B,
                   const VectorXd& start, double a, double w, double duration,
                   const std::function<double(double)>& formula) {
  LinearOde ode(F, B, a, w);
  Stepper stepper(ode, {StepPolicy::Kind::kAdaptive});
  VectorXd x = start;
  Matched matched;
  for (int i = 0; i < kPlaces; ++i) {
    const double t = duration * i / kPlaces;
    const double next = duration * (i + 1) / kPlaces;
    if (!stepper.advance(t, next, {x.data(), static_cast<std::size_t>(x.size())})) break;
    matched.note(formula(next), x[0]);
  }
  return matched.told(std::move(key), std::move(meaning));
}

/// Calls back at every sample.
class Looker : public Spectator {
 public:
  explicit Looker(std::function<bool(double, const model::State&)> look) : look_(std::move(look)) {}
  void sample(const Sample& sample) override { more_ = more_ && look_(sample.t, sample.state); }
  bool go_on(const Outcome&) override { return more_; }

 private:
  std::function<bool(double, const model::State&)> look_;
  bool more_ = true;
};

/// The rig without law, friction and rotor drives, the drives giving `torque` if anything.
void integrate(Rig rig, model::Machine machine, const model::State& start, double duration,
               const std::optional<InputFunction<DriveTorques>>& torque,
               const std::function<bool(double, const model::State&)>& look) {
  rig.controller.law = LawKind::kNone;
  rig.loop.state = StateSource::kTruth;
  machine = with_ideal_drives(std::move(machine));
  Scenario scenario;
  scenario.start = start;
  scenario.duration = duration;
  scenario.sample = duration / kPlaces;
  scenario.sampled = false;
  scenario.stepping.kind = StepPolicy::Kind::kAdaptive;
  scenario.torque = torque;
  Looker looker(look);
  simulate(rig, machine, scenario, looker);
}

/// The first bounce of the whole machine off its ring: how high, and when it is back.
struct Bounce {
  double peak = 0.0;    // [rad]
  double period = 0.0;  // [s]
};

Bounce bounce_by_formula(const model::ReducedUmbrella& r, double disc_rate, double tilt_rate) {
  const double wn = std::sqrt((r.H * r.H / r.C - r.U) / r.A);
  const double centre = r.H * r.C * disc_rate / (r.H * r.H - r.U * r.C);  // < 0
  const double swing = std::hypot(centre, tilt_rate / wn);
  return {centre + swing, 2.0 / wn * std::atan2(tilt_rate, -wn * centre)};
}

Bounce bounce_of_machine(const Rig& rig, model::UmbrellaParameters p, double disc_rate,
                         double tilt_rate, double guess) {
  p.mount = model::Mount::kLevel;
  p.track = model::TrackKind::kLower;
  p.structure.damping = p.disc.viscous_friction = p.disc.coulomb_friction = 0.0;
  p.gyros.damping = p.contact.damping = p.contact.rolling_drag = 0.0;
  Rig level = rig;
  level.machine = p;
  const model::Machine machine = level.build_machine();
  // The raised axle moves with its ring from the first.
  const double k = model::reduce(p).k;
  const model::State start = machine.state({0.0, 0.0, 0.0, p.gyros.ring_elevation},
                                           {tilt_rate, 0.0, disc_rate, k * tilt_rate});
  Bounce bounce;
  double before_t = 0.0, before = 0.0;
  integrate(level, machine, start, 6.0 * guess, std::nullopt,
            [&](double t, const model::State& state) {
              const double tilt = state.q[0];
              bounce.peak = std::max(bounce.peak, tilt);
              if (t > 0.0 && tilt <= 0.0 && before > 0.0) {
                bounce.period = before_t + before / (before - tilt) * (t - before_t);
                return false;
              }
              before_t = t;
              before = tilt;
              return true;
            });
  return bounce;
}

Comparison number(std::string key, std::string meaning, double formula, double integrated,
                  std::string unit) {
  return {
      std::move(key), std::move(meaning), formula, integrated, std::abs(integrated / formula - 1.0),
      std::move(unit)};
}

void compare_bounces(const Rig& rig, const model::UmbrellaParameters& p,
                     std::vector<Comparison>& all) {
  const model::ReducedUmbrella r = model::reduce(p);
  const double speed = rig.controller.disc_speed.value_or(0.0);
  if (p.mount != model::Mount::kLevel || p.track == model::TrackKind::kNone ||
      r.stability_ratio() <= 1.0 || speed <= 0.0 || r.H <= 0.0) {
    return;
  }
  const double tilt_rate = 0.1 * r.H * speed / std::sqrt(r.A * r.U);
  const Bounce formula = bounce_by_formula(r, -speed, tilt_rate);
  const auto tell = [&](const std::string& key, const std::string& ring, double stiffness) {
    model::UmbrellaParameters with = p;
    with.contact.stiffness = stiffness;
    const Bounce seen = bounce_of_machine(rig, with, -speed, tilt_rate, formula.period);
    if (seen.period <= 0.0) return;
    const std::string what = "thrown up once, disc level and undriven, " + ring + ": ";
    all.push_back(
        number("bounce_peak" + key, what + "highest tilt", formula.peak, seen.peak, "rad"));
    all.push_back(number("bounce_time" + key, what + "time until it is back", formula.period,
                         seen.period, "s"));
  };
  tell("", "the rig's own ring, which gives (the formula's does not)", p.contact.stiffness);
  tell("_hard", "a ring 1000 times as hard", 1000.0 * p.contact.stiffness);
}

void compare_umbrella(const Rig& rig, const model::UmbrellaParameters& p,
                      std::vector<Comparison>& all) {
  const model::ReducedUmbrella r = model::reduce(p);
  model::UmbrellaParameters frictionless = p;
  frictionless.structure.damping = frictionless.disc.viscous_friction = 0.0;
  const Branch ideal = branch_of(frictionless);
  const double square = (r.H * r.H / r.C - r.U) / r.A;
  const double rate = std::sqrt(std::abs(square));
  const double duration = square > 0.0 ? 3.0 * 2.0 * std::numbers::pi / rate : 3.0 / rate;
  const ReducedState start{kSmall, 0.1 * kSmall * rate, 0.0};
  const Eigen::Vector3d x0(start.tilt, start.tilt_rate, start.disc_rate);
  all.push_back(reduced("free", "released at 1 deg, no friction: tilt of the reduced model",
                        ideal.F, ideal.B, x0, 0.0, 0.0, duration,
                        [&](double t) { return free_motion(r, start, t).tilt; }));
  if (r.H == 0.0) return;  // the disc does not reach the structure
  const double F = 0.1 * r.U * kSmall * r.C * rate / r.H;
  const double w = 0.6 * rate;
  all.push_back(reduced("driven", "the same, the disc driven by a sine torque", ideal.F, ideal.B,
                        x0, F, w, duration,
                        [&](double t) { return driven_motion(r, start, F, w, t).tilt; }));
  const Branch real = branch_of(p);
  const LinearMotion damped(real.F, real.B, x0, F, w);
  all.push_back(reduced("driven_damped", "the same with the rig's friction", real.F, real.B, x0, F,
                        w, duration, [&](double t) { return damped.at(t)[0]; }));
  compare_bounces(rig, p, all);
}

void compare_gimballed(const Rig& rig, const model::GimballedParameters& p,
                       std::vector<Comparison>& all) {
  const GimbalAxes axes(p);
  const model::ReducedGimballed r = model::reduce(p);
  const model::Machine machine = rig.build_machine();
  const double sign = p.arrangement == model::Arrangement::kSingle ? -1.0 : 1.0;
  if (r.H == 0.0) return;  // the gimbals turn nothing
  const double nutation = std::abs(r.H) / std::sqrt(r.A * r.J);
  const double duration = 6.0 * 2.0 * std::numbers::pi / nutation;
  const int gimbal = machine.layout.gimbals[0].coordinate;
  const Eigen::Vector4d x0(0.1 * kSmall, 0.0, 0.0, 0.0);
  model::State start = machine.state({}, {});
  start.q[0] = x0[0];
  const double a = 0.5 * r.U * x0[0];
  const double w = 0.4 * nutation;
  const auto compare = [&](const std::string& key, const std::string& meaning, double amplitude) {
    const LinearMotion formula(axes.F(), axes.B(), x0, amplitude, w);
    InputFunction<DriveTorques> torque;
    torque.value = [=](const Instant& now) {
      DriveTorques torques{};
      torques[0] = sign * amplitude * std::sin(w * now.t);
      return torques;
    };
    Matched matched;
    Matched precession;
    integrate(rig, machine, start, duration, torque, [&](double t, const model::State& state) {
      const VectorXd x = formula.at(t);
      matched.note(x[0], state.q[0]);
      precession.note(x[2], sign * state.q[gimbal]);
      return true;
    });
    all.push_back(matched.told(key, meaning + ": roll of the whole machine"));
    all.push_back(precession.told(key + "_gimbal", meaning + ": its gimbals"));
  };
  compare("free", "released at 0.1 deg, undriven, six nutations", 0.0);
  compare("driven", "the same, the gimbals driven by a sine torque", a);
}

void compare_gyroscope(const Rig& rig, const model::GyroscopeParameters& p,
                       std::vector<Comparison>& all) {
  const double h = p.gyro.rotor_inertia * p.gyro.rotor_speed;
  if (h == 0.0) return;
  Rig frictionless = rig;
  auto& gyro = std::get<model::GyroscopeParameters>(frictionless.machine).gyro;
  gyro.post_damping = gyro.hinge_damping = 0.0;
  const double formula = p.gyro.mass * model::kGravity * p.gyro.cm_distance / h;
  const model::Machine machine = frictionless.build_machine();
  double seen = 0.0;
  integrate(frictionless, machine, machine.state({0.0, 0.0}, {formula, 0.0}), 5.0, std::nullopt,
            [&](double t, const model::State& state) {
              if (t > 0.0) seen = state.q[0] / t;
              return true;
            });
  all.push_back(number("precession", "T = I w W: precession of the level axle under its weight",
                       formula, seen, "rad/s"));
}

}  // namespace

ReducedState free_motion(const model::ReducedUmbrella& reduced, const ReducedState& start,
                         double t) {
  const auto& [A, C, U, H, k, Nh] = reduced;
  const double momentum = C * start.disc_rate + H * start.tilt;
  const double centre = H * momentum / (H * H - U * C);
  const double square = (H * H / C - U) / A;
  const double w = std::sqrt(std::abs(square));
  const bool swings = square > 0.0;
  const double c = swings ? std::cos(w * t) : std::cosh(w * t);
  const double s = swings ? std::sin(w * t) : std::sinh(w * t);
  const double away = start.tilt - centre;
  const double tilt = centre + away * c + start.tilt_rate / w * s;
  const double tilt_rate = (swings ? -away : away) * w * s + start.tilt_rate * c;
  return {tilt, tilt_rate, (momentum - H * tilt) / C};
}

ReducedState driven_motion(const model::ReducedUmbrella& reduced, const ReducedState& start,
                           double F, double w, double t) {
  const auto& [A, C, U, H, k, Nh] = reduced;
  // The sine's start gives the disc the mean momentum F / w; the rest is a swing about it.
  const double square = (H * H / C - U) / A;
  const double a = -H * F / (A * C * w * (square - w * w));
  const ReducedState rest{start.tilt - a, start.tilt_rate, start.disc_rate + (F / w + H * a) / C};
  const ReducedState free = free_motion(reduced, rest, t);
  const double tilt = free.tilt + a * std::cos(w * t);
  const double momentum = C * start.disc_rate + H * start.tilt + F / w * (1.0 - std::cos(w * t));
  return {tilt, free.tilt_rate - a * w * std::sin(w * t), (momentum - H * tilt) / C};
}

std::vector<Comparison> compare_solutions(const Rig& rig) {
  std::vector<Comparison> all;
  if (const auto* umbrella = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    compare_umbrella(rig, *umbrella, all);
  } else if (const auto* gimballed = std::get_if<model::GimballedParameters>(&rig.machine)) {
    compare_gimballed(rig, *gimballed, all);
  } else {
    compare_gyroscope(rig, std::get<model::GyroscopeParameters>(rig.machine), all);
  }
  return all;
}

}  // namespace gyrotwin
