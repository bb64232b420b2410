#include "clients/analyze/gimballed_theory.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "clients/analyze/loop.hpp"
#include "services/controller/law.hpp"

namespace gyrotwin {

namespace {

/// u = -tilt th - rate th' + spring q - damping q' of the law about upright, on the roll axis at
/// sign +1.
struct Gains {
  double tilt = 0.0, rate = 0.0, spring = 0.0, damping = 0.0;
};

Gains gains_of(const Rig& rig, const model::GimballedParameters& p, const model::Machine& machine) {
  if (rig.controller.law == LawKind::kNone || rig.controller.law == LawKind::kOpenLoop) return {};
  const std::unique_ptr<Law> law = make_law(rig);
  const double sign = p.arrangement == model::Arrangement::kSingle ? -1.0 : 1.0;
  const int gimbal = machine.layout.gimbals[0].coordinate;
  const auto slope = [&](auto&& set) {
    model::State above = machine.state({}, {}), below = above;
    set(above, Loop::kStep);
    set(below, -Loop::kStep);
    const auto torque = [&](const model::State& state) {
      return law->torque(machine.observe(state), LawState::Zero())[0];
    };
    return sign * (torque(above) - torque(below)) / (2.0 * Loop::kStep);
  };
  return {-slope([](model::State& s, double d) { s.q[0] = d; }),
          -slope([](model::State& s, double d) { s.v[0] = d; }),
          slope([&](model::State& s, double d) { s.q[gimbal] = sign * d; }),
          -slope([&](model::State& s, double d) { s.v[gimbal] = sign * d; })};
}

Criterion criterion_of(const char* name, const model::ReducedGimballed& r, const Gains& g) {
  const auto& [A, J, U, H, cth, cq] = r;
  const double c = cq + g.damping;
  const Polynomial polynomial{A * J, A * c + J * cth,
                              H * H + H * g.rate + cth * c - A * g.spring - J * U,
                              H * g.tilt - U * c - cth * g.spring, U * g.spring};
  return {name,
          "A J s^4 + (A cq + J cth) s^3 + (H^2 + H krate + cth cq - A kap - J U) s^2 + "
          "(H kth - U cq - cth kap) s + U kap",
          polynomial, routh(polynomial)};
}

}  // namespace

Theory gimballed_theory(const Rig& rig, const model::GimballedParameters& p) {
  const model::Machine machine = rig.build_machine();
  const model::ReducedGimballed r = model::reduce(p);
  const auto& [A, J, U, H, cth, cq] = r;
  const Gains g = gains_of(rig, p, machine);
  Theory theory;
  const auto add = [&](const char* key, const char* symbol, const char* meaning, double value,
                       const char* unit) {
    theory.numbers.push_back({key, symbol, meaning, value, unit});
  };
  add("coupling", "H", "momentum that a gimbal coordinate turns", H, "N m s");
  add("tilt_inertia", "A", "about the support", A, "kg m^2");
  add("gimbal_inertia", "J", "of a gimbal coordinate", J, "kg m^2");
  add("toppling_stiffness", "U", "moment of the weight per tilt", U, "N m/rad");
  add("topples_in", "sqrt(A/U)", "time in which an unsupported tilt grows e-fold", std::sqrt(A / U),
      "s");
  add("stability_ratio", "H^2/(J U)", "above 1 precession can carry the weight", H * H / (J * U),
      "");
  add("nutation", "H/sqrt(A J)", "fast swing of tilt against gimbals", H / std::sqrt(A * J),
      "rad/s");
  if (g.spring > 0.0) {
    add("slow_rate", "sqrt(U kap)/H", "slow swing of the leaning machine",
        std::sqrt(U * g.spring) / H, "rad/s");
  }
  add("impulse_limit", "H sin(qmax)", "impulse that turns the gyros to their stops",
      H * std::sin(std::min(p.gyros.stop, 1.5707963)), "N m s");
  if (g.spring > 0.0 && g.tilt > 0.0) {
    add("moment_limit", "U kap qmax/kth",
        "constant moment whose lean takes the gyros to their stops",
        U * g.spring * p.gyros.stop / g.tilt, "N m");
    add("lean", "kth/(U kap)", "gimbal turn per constant moment; it leans into it by M/U",
        g.tilt / (U * g.spring), "rad/(N m)");
  }

  auto& all = theory.conditions;
  all.push_back(above("inequality", "H^2 > J U",
                      "the gyros precess slower than the machine topples", H * H, J * U,
                      "N^2 m^2 s^2", true));
  all.push_back(above("accelerating", "kap > 0",
                      "the gimbals must be pushed on in their precession, not held back (Brennan)",
                      g.spring, 0.0, "N m/rad", true));
  if (g.spring > 0.0 && g.tilt == 0.0 && g.damping == 0.0) {
    all.push_back(above("passive", "H > sqrt(A kap) + sqrt(J U)",
                        "two unstable axes hold each other", H,
                        std::sqrt(A * g.spring) + std::sqrt(J * U), "N m s", true));
  }
  if (g.tilt > 0.0) {
    all.push_back(above("nutation_damped", "cq > kth J/(H + krate)", "less pumps the nutation",
                        cq + g.damping, g.tilt * J / (H + g.rate), "N m s/rad", true));
    all.push_back(below("precession_damped", "cq < kth H/U", "more lets the slow swing grow",
                        cq + g.damping, (H * g.tilt - cth * g.spring) / U, "N m s/rad", true));
  }
  all.push_back(below("push", "reference push < H sin(qmax)",
                      "the gyros take the rig's reference push before they meet their stops",
                      rig.reference_impulse_nms, H * std::sin(std::min(p.gyros.stop, 1.5707963)),
                      "N m s", false));
  theory.criteria.push_back(criterion_of("gimbals left alone", r, {}));
  if (rig.controller.law != LawKind::kNone && rig.controller.law != LawKind::kOpenLoop) {
    theory.criteria.push_back(criterion_of("under the law, about upright", r, g));
  }
  return theory;
}

Theory gyroscope_theory(const Rig& rig, const model::GyroscopeParameters& p) {
  const auto& y = p.gyro;
  const double h = y.rotor_inertia * y.rotor_speed;
  const double J = y.inertia_transverse + y.mass * y.cm_distance * y.cm_distance;
  const double weight = y.mass * model::kGravity * y.cm_distance;
  Theory theory;
  const auto add = [&](const char* key, const char* symbol, const char* meaning, double value,
                       const char* unit) {
    theory.numbers.push_back({key, symbol, meaning, value, unit});
  };
  add("momentum", "h", "of the flywheel", h, "N m s");
  add("weight_moment", "m g d", "about the hinge, axle level", weight, "N m");
  add("precession", "m g d/h", "that carries the weight: T = I w W", weight / h, "rad/s");
  add("nutation", "h/sqrt(J Jpsi)", "fast swing of the axle",
      h / std::sqrt(J * (y.post_inertia + J)), "rad/s");
  add("sink_rate", "cp W/h", "at which friction of the post lowers the axle, left alone",
      y.post_damping * weight / (h * h), "rad/s");
  const double until = y.post_damping > 0.0 ? y.stop * h * h / (y.post_damping * weight) : 0.0;
  theory.conditions.push_back(above("spin", "h > 0",
                                    "a flywheel that does not spin carries nothing", std::abs(h),
                                    0.0, "N m s", true));
  const bool driven = rig.controller.law != LawKind::kNone;
  if (until > 0.0) {
    theory.conditions.push_back(below("post_friction", "the drive replaces what the post takes",
                                      "left alone the axle sinks to its stop",
                                      driven ? 0.0 : 1.0 / until, 1e-9, "1/s", false));
  }
  return theory;
}

}  // namespace gyrotwin
