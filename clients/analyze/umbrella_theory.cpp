#include "clients/analyze/umbrella_theory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/model/umbrella.hpp"

namespace gyrotwin {

namespace {

using model::Mount;
using model::TrackKind;
using model::UmbrellaParameters;

/// Everything that the formulas share; symbols as in services/model/README.md.
struct Symbols {
  model::ReducedUmbrella r;
  double b, cs;      // friction of disc and ground [N m s/rad]
  double shorted;    // b with the drive's motor shorted [N m s/rad]
  double speed;      // Omega, of the disc, signed [rad/s]
  double S1, P;      // m e of disc and gyros [kg m]; their pendulous stiffness [N m/rad]
  double Jt;         // tilt inertia of everything locked, about the ground [kg m^2]
  double L;          // momentum along the disc's axis [N m s]
  double no_load;    // of the drive [rad/s]
  double preload;    // of one axle on the ring, steady [N]
  double sink;       // of one axle [m]
  double stiffness;  // k_tilt of all axles and the bushing [N m/rad]
  double damping;    // crot likewise [N m s/rad]
};

double planar_inertia(const UmbrellaParameters& p) {
  const auto& g = p.gyros;
  const double c = std::cos(g.ring_elevation), s = std::sin(g.ring_elevation);
  const double rho = g.pivot_radius + g.cm_distance * c;
  const double zc = g.pivot_height + g.cm_distance * s;
  return p.disc.inertia_planar + p.disc.mass * p.disc.cm_offset * p.disc.cm_offset +
         g.count * (g.mass * (0.5 * rho * rho + zc * zc) +
                    0.5 * (g.inertia_transverse * (1.0 + s * s) + g.inertia_axial * c * c));
}

void add_ring(const Rig& rig, const UmbrellaParameters& p, const std::optional<LinearModel>& linear,
              Symbols& x) {
  if (!linear || p.track == TrackKind::kNone) return;
  const model::Machine machine = rig.build_machine();
  const model::Truth truth = machine.truth(linear->steady.state, {});
  x.preload = std::max(truth.contact_lower[0], truth.contact_upper[0]);
  x.sink = std::pow(x.preload / p.contact.stiffness, 2.0 / 3.0);
  const double radius =
      p.gyros.pivot_radius + p.gyros.axle_length * std::cos(p.gyros.ring_elevation);
  const double half = 0.5 * p.gyros.count * radius * radius;
  x.stiffness += half * 1.5 * p.contact.stiffness * std::sqrt(x.sink);
  x.damping += half * p.contact.damping * p.contact.stiffness * std::pow(x.sink, 1.5);
}

Symbols symbols_of(const Rig& rig, const UmbrellaParameters& p,
                   const std::optional<LinearModel>& linear) {
  Symbols x{};
  x.r = model::reduce(p);
  x.b = p.disc.viscous_friction;
  x.cs = p.structure.damping;
  const double KtG = p.drive.motor.torque_constant * p.drive.motor.gear_ratio;
  x.shorted = x.b + KtG * KtG / p.drive.motor.resistance;
  x.no_load = p.drive.motor.supply_voltage / KtG;
  const model::Machine machine = rig.build_machine();
  x.speed = linear ? linear->steady.state.v[machine.layout.disc]
                   : rig.initial_state(machine).v[machine.layout.disc];
  const double zc = p.gyros.pivot_height + p.gyros.cm_distance * std::sin(p.gyros.ring_elevation);
  x.S1 = p.disc.mass * p.disc.cm_offset + p.gyros.count * p.gyros.mass * zc;
  x.P = -x.S1 * model::kGravity;
  const double hd = p.disc.joint_height;
  const double moving = p.disc.mass + p.gyros.count * p.gyros.mass;
  x.Jt = p.structure.inertia_x + moving * hd * hd + planar_inertia(p) + 2.0 * hd * x.S1;
  const double Jz = x.r.C;
  x.L = Jz * x.speed + x.r.Nh * std::sin(p.gyros.ring_elevation);
  x.stiffness = p.bushing.stiffness;
  x.damping = p.bushing.rotating_damping;
  add_ring(rig, p, linear, x);
  return x;
}

/// Adds to a list of numbers.
class Teller {
 public:
  explicit Teller(std::vector<DerivedNumber>& all) : all_(all) {}
  void operator()(const char* key, const char* symbol, const char* meaning, double value,
                  const char* unit) const {
    all_.push_back({key, symbol, meaning, value, unit});
  }

 private:
  std::vector<DerivedNumber>& all_;
};

void add_numbers(const UmbrellaParameters& p, const Symbols& x, const Teller& add) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  add("momentum", "N h", "momentum of all flywheels", Nh, "N m s");
  add("toppling_stiffness", "U", "moment of the weight per tilt", U, "N m/rad");
  add("tilt_inertia", "A", "about the ground, disc level", A, "kg m^2");
  add("topples_in", "sqrt(A/U)", "time in which an unsupported tilt grows e-fold", std::sqrt(A / U),
      "s");
  add("elevation_per_tilt", "k", "how much a gyro is raised by a tilt of the ring", k, "");
  add("coupling", "H", "tilt rate to disc torque, and disc speed to tilt moment, disc level", H,
      "N m s");
  add("disc_inertia", "C", "about the disc's axis, geared motor included", C, "kg m^2");
  add("stability_ratio", "H^2/(C U)",
      "above 1 a platform with a level disc swings instead of falling", x.r.stability_ratio(), "");
  add("disc_speed", "Omega", "of the disc, steady", x.speed, "rad/s");
  add("no_load_speed", "Vb/(Kt G)", "of the disc's drive", x.no_load, "rad/s");
  if (p.track != TrackKind::kNone) {
    add("axle_preload", "F_n", "of one axle on the ring, steady", x.preload, "N");
    add("axle_sink", "delta", "of one axle, steady", x.sink, "m");
  }
  add("ring_stiffness", "k_tilt", "of axles and bushing between structure and disc, steady",
      x.stiffness, "N m/rad");
  add("ring_damping", "crot", "likewise, turning with the disc", x.damping, "N m s/rad");
  add("pendulous_stiffness", "P", "of disc and gyros below their joint", x.P, "N m/rad");
}

void add_level_numbers(const UmbrellaParameters& p, const Symbols& x, const Teller& add) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  if (x.r.stability_ratio() > 1.0) {
    add("swing_rate", "wn", "its swing on a hard ring, disc left alone",
        std::sqrt((H * H / C - U) / A), "rad/s");
    add("friction_growth", "U b/(H^2-U C)", "slow fall by the disc's viscous friction, left alone",
        U * x.b / (H * H - U * C), "1/s");
    add("shorted_growth", "U b/(H^2-U C)", "the same with the drive's motor shorted",
        U * x.shorted / (H * H - U * C), "1/s");
  }
  const double speed = std::abs(x.speed);
  add("wall_moment", "H |Omega|", "restoring moment at that speed, at once", H * speed, "N m");
  add("wall_tilt", "H |Omega|/U", "tilt up to which it restores", H * speed / U, "rad");
  add("wall_impulse", "H |Omega| sqrt(A/U)", "impulse that takes it there, disc speed held",
      H * speed * std::sqrt(A / U), "N m s");
  const double top = p.gyros.stop_upper;
  add("passive_moment", "(N h)^2 k (sin tgmax - sin tg0) cos tgmax/C",
      "largest restoring moment with the disc left alone, at the gimbals' stop",
      Nh * Nh * k * (std::sin(top) - std::sin(p.gyros.ring_elevation)) * std::cos(top) / C, "N m");
}

void add_top_numbers(const Symbols& x, const Teller& add) {
  add("axial_momentum", "L", "along the disc's axis: Jz Omega + N h sin tg0", x.L, "N m s");
  add("top_inertia", "Jt", "of everything locked together, about the ground", x.Jt, "kg m^2");
  const double square = x.L * x.L - 4.0 * x.Jt * (x.r.U - x.P);
  if (square <= 0.0) return;
  const double root = std::sqrt(square);
  add("slow_precession", "(|L| - sqrt(L^2 - 4 Jt (U-P)))/(2 Jt)", "of the locked sleeping top",
      (std::abs(x.L) - root) / (2.0 * x.Jt), "rad/s");
  add("fast_precession", "(|L| + sqrt(L^2 - 4 Jt (U-P)))/(2 Jt)", "of the locked sleeping top",
      (std::abs(x.L) + root) / (2.0 * x.Jt), "rad/s");
}

Criterion disc_criterion(const char* name, const Symbols& x, double b) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  const Polynomial polynomial{A * C, A * b + C * x.cs, H * H - C * U + b * x.cs, -U * b};
  return {name, "A C s^3 + (A b + C cs) s^2 + (H^2 - C U + b cs) s - U b", polynomial,
          routh(polynomial)};
}

void add_level(const Rig& rig, const UmbrellaParameters& p, const Symbols& x, Theory& theory) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  auto& all = theory.conditions;
  const bool driven = rig.controller.law != LawKind::kNone;
  all.push_back(above("ring", "a track", "the gyros reach the structure through their ring alone",
                      p.track == TrackKind::kNone ? 0.0 : 1.0, 0.5, "", true));
  all.push_back(above("inequality", "H^2 > C U", "disc left alone: it swings; otherwise it falls",
                      H * H, C * U, "N^2 m^2 s^2", !driven));
  const double left = driven ? 0.0 : U * x.b / std::max(H * H - U * C, 1e-300);
  all.push_back(below("friction", "the drive replaces what friction takes",
                      "viscous friction b on the disc lets it fall slowly, as exp(U b t/(H^2-U C))",
                      H * H > U * C ? left : 0.0, 1e-9, "1/s", false));
  const double fall = rig.safety.fall_tilt_rad;
  all.push_back(above("restoring_moment", "H^2/C theta > U theta",
                      "restoring moment of the free disc beats the weight (inequality 4.47)",
                      H * H / C * fall, U * fall, "N m", false));
  all.push_back(above("drive_speed", "N h k w_noload > U theta",
                      "restoring moment at the drive's highest speed beats the weight at the fall "
                      "limit",
                      H * x.no_load, U * fall, "N m", false));
  if (x.speed != 0.0) {
    const double start = rig.build_machine().tilt(rig.initial_state(rig.build_machine()));
    all.push_back(above("start", "theta_0 < H |Omega|/U",
                        "it is released where the turning disc still restores",
                        H * std::abs(x.speed) / U, start, "rad", driven));
    all.push_back(above("push", "reference push < H |Omega| sqrt(A/U)",
                        "the turning disc takes the rig's reference push at held speed",
                        H * std::abs(x.speed) * std::sqrt(A / U), rig.reference_impulse_nms,
                        "N m s", false));
  }
  theory.criteria.push_back(disc_criterion("disc left alone, the rig's friction", x, x.b));
  theory.criteria.push_back(disc_criterion("disc left alone, its motor shorted", x, x.shorted));
}

void add_free(const UmbrellaParameters& p, const Symbols& x, Theory& theory) {
  const double U = x.r.U;
  auto& all = theory.conditions;
  all.push_back(above("statics", "P > U",
                      "without spin it would have to hang: no spring, and no torque of the drive, "
                      "between structure and disc holds a free disc up",
                      x.P, U, "N m/rad", false));
  all.push_back(above("sleeping_top", "L^2 > 4 Jt (U - P)",
                      "the flywheels' and the disc's momentum along its axis carries it as a "
                      "sleeping top",
                      x.L * x.L, 4.0 * x.Jt * (U - x.P), "N^2 m^2 s^2", true));
  if (p.mount == Mount::kRigid) {
    all.push_back(below("spiral", "cs = 0",
                        "friction of the ground makes a sleeping top spiral out, and a rigid disc "
                        "has nothing against it",
                        x.cs, 1e-12, "N m s/rad", false));
    return;
  }
  const double square = x.L * x.L - 4.0 * x.Jt * (U - x.P);
  all.push_back(above("same_sense", "L Omega > 0",
                      "the disc turns with the momentum, so that damping which turns with it calms "
                      "the slow precession",
                      x.L * x.speed, 0.0, "N m s rad/s", true));
  if (square > 0.0) {
    const double slow = (std::abs(x.L) - std::sqrt(square)) / (2.0 * x.Jt);
    const double fast = (std::abs(x.L) + std::sqrt(square)) / (2.0 * x.Jt);
    all.push_back(above("faster_than_slow", "|Omega| > slow precession", "only then it calms it",
                        std::abs(x.speed), slow, "rad/s", true));
    all.push_back(below("slower_than_fast", "|Omega| < fast precession",
                        "faster it excites the fast precession", std::abs(x.speed), fast, "rad/s",
                        true));
  }
  all.push_back(above("stiff_enough", "k_tilt > 3 U",
                      "axles or bushing too soft to carry the structure on the disc", x.stiffness,
                      3.0 * U, "N m/rad", false));
  all.push_back(below("soft_enough", "k_tilt < 20 U",
                      "hard axles lose the rotating damping (5 to 10 U is a good aim)", x.stiffness,
                      20.0 * U, "N m/rad", false));
  all.push_back(above("damped_enough", "crot > 0.05 s k_tilt",
                      "damping that turns with the disc (0.1 to 0.2 s is a good aim)", x.damping,
                      0.05 * x.stiffness, "N m s/rad", false));
}

}  // namespace

Theory umbrella_theory(const Rig& rig, const UmbrellaParameters& p,
                       const std::optional<LinearModel>& linear) {
  const Symbols x = symbols_of(rig, p, linear);
  Theory theory;
  const Teller add(theory.numbers);
  add_numbers(p, x, add);
  if (p.mount == Mount::kLevel) {
    add_level_numbers(p, x, add);
    add_level(rig, p, x, theory);
  } else {
    add_top_numbers(x, add);
    add_free(p, x, theory);
  }
  return theory;
}

}  // namespace gyrotwin
