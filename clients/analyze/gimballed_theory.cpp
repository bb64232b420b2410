#include "clients/analyze/gimballed_theory.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "clients/analyze/loop.hpp"
#include "services/controller/law.hpp"

namespace gyrotwin {

namespace {

/// u = -tilt th - rate th' + spring q - damping q' of the law about upright, on an axis whose
/// coupling has sign +1.
struct Gains {
  double tilt = 0.0, rate = 0.0, spring = 0.0, damping = 0.0;
};

/// A tilt and the gimbals that turn its momentum.
struct TiltAxis {
  const char* name;  // empty: there is only one
  Gains gains;
};

bool has_gains(const Rig& rig) {
  return rig.controller.law != LawKind::kNone && rig.controller.law != LawKind::kOpenLoop;
}

/// @param sign of the coupling: +1 for a pair on the roll axis
Gains gains_of(const Law& law, const model::Machine& machine, int axis, double sign) {
  const int tilt = machine.layout.tilt[static_cast<std::size_t>(axis)];
  const int gimbal = machine.drives[static_cast<std::size_t>(axis)].coordinate;
  const auto slope = [&](auto&& set) {
    model::State above = machine.state({}, {}), below = above;
    set(above, Loop::kStep);
    set(below, -Loop::kStep);
    const auto torque = [&](const model::State& state) {
      return law.torque(machine.observe(state), LawState::Zero())[static_cast<std::size_t>(axis)];
    };
    return sign * (torque(above) - torque(below)) / (2.0 * Loop::kStep);
  };
  return {-slope([=](model::State& s, double d) { s.q[tilt] = d; }),
          -slope([=](model::State& s, double d) { s.v[tilt] = d; }),
          slope([=](model::State& s, double d) { s.q[gimbal] = sign * d; }),
          -slope([=](model::State& s, double d) { s.v[gimbal] = sign * d; })};
}

std::vector<TiltAxis> axes_of(const Rig& rig, const model::GimballedParameters& p) {
  using model::Arrangement;
  const model::Machine machine = rig.build_machine();
  const std::unique_ptr<Law> law = has_gains(rig) ? make_law(rig) : nullptr;
  const auto gains = [&](int axis, double sign) {
    return law ? gains_of(*law, machine, axis, sign) : Gains{};
  };
  if (p.arrangement == Arrangement::kTwoPairs) {
    return {{", roll", gains(0, 1.0)}, {", pitch", gains(1, -1.0)}};
  }
  return {{"", gains(0, p.arrangement == Arrangement::kSingle ? -1.0 : 1.0)}};
}

Criterion criterion_of(const std::string& name, const model::ReducedGimballed& r, const Gains& g) {
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

double impulse_limit(const model::GimballedParameters& p, const model::ReducedGimballed& r) {
  return std::abs(r.H) * std::sin(std::min(p.gyros.stop, 0.5 * std::numbers::pi));
}

void add_numbers(const model::GimballedParameters& p, const model::ReducedGimballed& r,
                 const Gains& g, const Teller& add) {
  const auto& [A, J, U, H, cth, cq] = r;
  add("coupling", "H", "momentum that a gimbal coordinate turns", H, "N m s");
  add("tilt_inertia", "A", "about the support", A, "kg m^2");
  add("gimbal_inertia", "J", "of a gimbal coordinate", J, "kg m^2");
  add("toppling_stiffness", "U", "moment of the weight per tilt", U, "N m/rad");
  if (U > 0.0) {
    add("topples_in", "sqrt(A/U)", "time in which an unsupported tilt grows e-fold",
        std::sqrt(A / U), "s");
    add("stability_ratio", "H^2/(J U)", "above 1 precession can carry the weight", H * H / (J * U),
        "");
  }
  add("nutation", "H/sqrt(A J)", "fast swing of tilt against gimbals",
      std::abs(H) / std::sqrt(A * J), "rad/s");
  const double left = U * g.spring;
  if (left > 0.0 && H != 0.0) {
    add("slow_rate", "sqrt(U kap)/H", "slow swing of the leaning machine",
        std::sqrt(left) / std::abs(H), "rad/s");
  }
  add("impulse_limit", "H sin(qmax)", "impulse that turns the gyros to their stops",
      impulse_limit(p, r), "N m s");
  if (left > 0.0 && g.tilt != 0.0) {
    add("moment_limit", "U kap qmax/kth",
        "constant moment whose lean takes the gyros to their stops",
        left * p.gyros.stop / std::abs(g.tilt), "N m");
    add("lean", "kth/(U kap)", "gimbal turn per constant moment; it leans into it by M/U",
        std::abs(g.tilt) / left, "rad/(N m)");
  }
}

/// Without damping of the tilt and without kap they are exact; otherwise they tell why the scheme
/// fails.
void add_rules(const TiltAxis& axis, const model::ReducedGimballed& r,
               std::vector<Condition>& all) {
  const auto& [A, J, U, H, cth, cq] = r;
  const Gains& g = axis.gains;
  const std::string where = axis.name;
  all.push_back(above("accelerating", "U kap > 0" + where,
                      "the gimbals of the machine that topples are pushed on in their "
                      "precession, not held back (Brennan)",
                      U * g.spring, 0.0, "N^2 m^2/rad^2", Role::kExplains));
  if (U > 0.0 && g.spring > 0.0 && g.tilt == 0.0 && g.damping == 0.0) {
    all.push_back(above("passive", "H > sqrt(A kap) + sqrt(J U)" + where,
                        "two unstable axes hold each other", std::abs(H),
                        std::sqrt(A * g.spring) + std::sqrt(J * U), "N m s", Role::kExplains));
  }
  if (U > 0.0 && H * g.tilt > 0.0) {
    all.push_back(above("nutation_damped", "cq > kth J/(H + krate)" + where,
                        "enough damping not to pump the nutation", cq + g.damping,
                        g.tilt * J / (H + g.rate), "N m s/rad", Role::kExplains));
    all.push_back(below("precession_damped", "cq < (kth H - cth kap)/U" + where,
                        "little enough damping for the slow swing to die out", cq + g.damping,
                        (H * g.tilt - cth * g.spring) / U, "N m s/rad", Role::kExplains));
  }
}

bool alike(const Gains& a, const Gains& b) {
  const auto close = [](double x, double y) { return std::abs(x - y) <= 1e-6 * std::abs(x); };
  return close(a.tilt, b.tilt) && close(a.rate, b.rate) && close(a.spring, b.spring) &&
         close(a.damping, b.damping);
}

}  // namespace

Theory gimballed_theory(const Rig& rig, const model::GimballedParameters& p) {
  const model::ReducedGimballed r = model::reduce(p);
  std::vector<TiltAxis> axes = axes_of(rig, p);
  if (axes.size() == 2 && alike(axes[0].gains, axes[1].gains)) axes = {{"", axes[0].gains}};
  Theory theory;
  add_numbers(p, r, axes[0].gains, Teller(theory.numbers));

  auto& all = theory.conditions;
  for (const TiltAxis& axis : axes) {
    const std::string how = has_gains(rig) ? "under the law, about upright" : "gimbals left alone";
    const Criterion criterion = criterion_of(how + axis.name, r, axis.gains);
    all.push_back(
        yes_no("routh", "Routh's scheme" + std::string(axis.name),
               "the characteristic polynomial, " + how + ", has no root with a positive real part",
               criterion.scheme.unstable == 0, Role::kDecides));
    theory.criteria.push_back(criterion);
  }
  all.push_back(above("inequality", "H^2 > J U",
                      "the gyros precess slower than the machine topples", r.H * r.H, r.J * r.U,
                      "N^2 m^2 s^2", Role::kExplains));
  for (const TiltAxis& axis : axes) add_rules(axis, r, all);
  all.push_back(below("push", "reference push < H sin(qmax)",
                      "the gyros take the rig's reference push before they meet their stops",
                      rig.reference_impulse_nms, impulse_limit(p, r), "N m s", Role::kAdvises));
  if (has_gains(rig)) theory.criteria.push_back(criterion_of("gimbals left alone", r, {}));
  return theory;
}

Theory gyroscope_theory(const Rig& rig, const model::GyroscopeParameters& p) {
  const auto& y = p.gyro;
  const double h = y.rotor_inertia * y.rotor_speed;
  const double J = y.inertia_transverse + y.mass * y.cm_distance * y.cm_distance;
  const double weight = y.mass * model::kGravity * y.cm_distance;
  Theory theory;
  const Teller add(theory.numbers);
  add("momentum", "h", "of the flywheel", h, "N m s");
  add("weight_moment", "m g d", "about the hinge, axle level", weight, "N m");
  add("nutation", "h/sqrt(J Jpsi)", "fast swing of the axle",
      std::abs(h) / std::sqrt(J * (y.post_inertia + J)), "rad/s");
  if (h != 0.0) {
    add("precession", "m g d/h", "that carries the weight: T = I w W", weight / h, "rad/s");
    add("sink_rate", "cp W/h", "at which friction of the post lowers the axle, left alone",
        y.post_damping * weight / (h * h), "rad/s");
  }
  theory.conditions.push_back(yes_no("spin", "h != 0", "the flywheel spins, and so can carry",
                                     h != 0.0, weight != 0.0 ? Role::kDecides : Role::kAdvises));
  const bool driven = rig.controller.law != LawKind::kNone;
  if (y.post_damping * weight != 0.0) {
    theory.conditions.push_back(yes_no("post_friction", "the drive replaces what the post takes",
                                       "the axle does not sink to its stop", driven,
                                       Role::kAdvises));
  }
  return theory;
}

}  // namespace gyrotwin
