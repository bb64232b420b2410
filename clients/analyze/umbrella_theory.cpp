#include "clients/analyze/umbrella_theory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "clients/analyze/umbrella_symbols.hpp"

namespace gyrotwin {

namespace {

using model::Mount;
using model::TrackKind;
using model::UmbrellaParameters;

void add_numbers(const UmbrellaParameters& p, const Symbols& x, const Teller& add) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  add("momentum", "N h", "momentum of all flywheels", Nh, "N m s");
  add("toppling_stiffness", "U", "moment of the weight per tilt", U, "N m/rad");
  add("tilt_inertia", "A", "about the ground, disc level", A, "kg m^2");
  if (U > 0.0) {
    add("topples_in", "sqrt(A/U)", "time in which an unsupported tilt grows e-fold",
        std::sqrt(A / U), "s");
  }
  add("elevation_per_tilt", "k", "how much a gyro is raised by a tilt of the ring", k, "");
  add("coupling", "H", "tilt rate to disc torque, and disc speed to tilt moment, disc level", H,
      "N m s");
  add("disc_inertia", "C", "about the disc's axis, geared motor included", C, "kg m^2");
  if (U > 0.0) {
    add("stability_ratio", "H^2/(C U)",
        "above 1 a platform with a level disc swings instead of falling", x.r.stability_ratio(),
        "");
  }
  add("disc_speed", "Omega", "of the disc, steady", x.speed, "rad/s");
  add("no_load_speed", "Vb/(Kt G)", "of the disc's drive", x.no_load, "rad/s");
  if (p.track != TrackKind::kNone) {
    add("axle_preload", "F_n", "of one axle on the ring, steady", x.preload, "N");
    add("axle_sink", "delta", "of one axle, steady", x.sink, "m");
  }
  add("ring_stiffness", "k_tilt", "of axles and bushing between structure and disc, steady",
      x.between.stiffness, "N m/rad");
  add("ring_damping", "crot", "likewise, turning with the disc", x.between.rotating_damping,
      "N m s/rad");
  add("pendulous_stiffness", "P", "of disc and gyros below their joint", x.tilt.P, "N m/rad");
}

void add_level_numbers(const UmbrellaParameters& p, const Symbols& x, const Teller& add) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  if (H * H > C * U) {
    add("swing_rate", "wn", "its swing on a hard ring, disc left alone",
        std::sqrt((H * H / C - U) / A), "rad/s");
    add("friction_growth", "U b/(H^2-U C)", "slow fall by the disc's viscous friction, left alone",
        U * x.b / (H * H - U * C), "1/s");
    add("shorted_growth", "U b/(H^2-U C)", "the same with the drive's motor shorted",
        U * x.shorted / (H * H - U * C), "1/s");
  }
  const double wall = std::max(x.press, 0.0);
  add("wall_moment", "H |Omega|", "restoring moment of the pressed ring at that speed, at once",
      wall, "N m");
  if (U > 0.0) {
    add("wall_tilt", "H |Omega|/U",
        wall > 0.5 * std::numbers::pi * U ? "tilt up to which it restores: any (beyond 90 deg)"
                                          : "tilt up to which it restores",
        wall / U, "rad");
    add("wall_impulse", "H |Omega| sqrt(A/U)", "impulse that takes it there, disc speed held",
        wall * std::sqrt(A / U), "N m s");
  }
  const double top = p.gyros.stop_upper;
  add("passive_moment", "(N h)^2 k (sin tgmax - sin tg0) cos tgmax/C",
      "largest restoring moment with the disc left alone, at the gimbals' stop",
      Nh * Nh * k * (std::sin(top) - std::sin(p.gyros.ring_elevation)) * std::cos(top) / C, "N m");
}

void add_top_numbers(const Symbols& x, const Teller& add) {
  add("axial_momentum", "L", "along the disc's axis: Jz Omega + N h sin tg", x.L, "N m s");
  add("top_inertia", "Jt", "of everything locked together, about the ground, in roll",
      x.tilt.locked_inertia()[0], "kg m^2");
  add("hanging", "P/U",
      "above 1 it hangs; below, no spring and no torque of the drive between structure and disc "
      "holds a free disc up: only its spin can",
      x.tilt.P / x.tilt.U, "");
  add("tilt_growth", "growth", "of the tilts, by the equations of structure and disc", x.growth,
      "1/s");
  const auto top = model::precession(x.tilt, x.speed);
  if (!top) return;
  add("slow_precession", "(|L| - sqrt(L^2 - 4 Jt (U-P)))/(2 Jt)",
      "of the locked sleeping top (for Jt alike in roll and pitch)", top->slow, "rad/s");
  add("fast_precession", "(|L| + sqrt(L^2 - 4 Jt (U-P)))/(2 Jt)", "likewise", top->fast, "rad/s");
}

Role decides_if(bool decides) { return decides ? Role::kDecides : Role::kAdvises; }

Criterion disc_criterion(const char* name, const Symbols& x, double b) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  const Polynomial polynomial{A * C, A * b + C * x.cs, H * H - C * U + b * x.cs, -U * b};
  return {name, "A C s^3 + (A b + C cs) s^2 + (H^2 - C U + b cs) s - U b", polynomial,
          routh(polynomial)};
}

/// What decides in mount `level`, where the gyros reach the structure through their ring alone.
void add_ring_conditions(const UmbrellaParameters& p, const Symbols& x, bool driven,
                         std::vector<Condition>& all) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  const bool track = p.track != TrackKind::kNone;
  all.push_back(yes_no("ring", "a track", "the gyros reach the structure through their ring alone",
                       track, decides_if(!x.carried)));
  if (track && x.speed != 0.0) {
    all.push_back(above("pressed", p.track == TrackKind::kSlot ? "H |Omega| > 0" : "-H Omega > 0",
                        "the turning disc presses the axles on their ring and does not lift them",
                        x.press, 0.0, "N m", decides_if(!x.carried)));
  }
  all.push_back(above("inequality", "H^2 > C U",
                      "disc at rest and left alone: its restoring moment H^2/C theta beats the "
                      "weight's U theta and it swings (the thesis' inequality 4.47, M_max > U "
                      "theta)",
                      H * H, C * U, "N^2 m^2 s^2",
                      x.carried || !track         ? Role::kAdvises
                      : !driven && x.speed == 0.0 ? Role::kDecides
                                                  : Role::kExplains));
  if (H * H > C * U) {
    all.push_back(
        yes_no("friction", "the drive replaces what friction takes",
               "the disc keeps its momentum, of which viscous friction b alone would take so "
               "much that the tilt grows as exp(U b t/(H^2-U C))",
               driven || U * x.b <= 0.0, Role::kAdvises));
  }
}

void add_level(const Rig& rig, const UmbrellaParameters& p, const Symbols& x, Theory& theory) {
  const auto& [A, C, U, H, k, Nh] = x.r;
  auto& all = theory.conditions;
  add_ring_conditions(p, x, rig.controller.law != LawKind::kNone, all);
  all.push_back(above("drive_speed", "N h k w_noload > U theta",
                      "restoring moment at the drive's highest speed beats the weight at the fall "
                      "limit",
                      std::abs(H) * x.no_load, U * rig.safety.fall_tilt_rad, "N m",
                      Role::kAdvises));
  if (x.speed != 0.0 && U > 0.0) {
    const model::Machine machine = rig.build_machine();
    const double wall = std::max(x.press, 0.0);
    all.push_back(
        below("start", "theta_0 < H |Omega|/U",
              wall > 0.5 * std::numbers::pi * U
                  ? "it is released where the disc, its speed held, still restores: at any "
                    "tilt"
                  : "it is released where the disc, its speed held, still restores",
              machine.tilt(rig.initial_state(machine)), wall / U, "rad", Role::kAdvises));
    all.push_back(below("push", "reference push < H |Omega| sqrt(A/U)",
                        "the turning disc takes the rig's reference push at held speed; a drive "
                        "that speeds it up takes more",
                        rig.reference_impulse_nms, wall * std::sqrt(A / U), "N m s",
                        Role::kAdvises));
  }
  theory.criteria.push_back(disc_criterion("disc left alone, the rig's friction", x, x.b));
  theory.criteria.push_back(disc_criterion("disc left alone, its motor shorted", x, x.shorted));
}

/// Rules of thumb for damping that turns with the disc to calm a sleeping top.
void add_calming(const Symbols& x, std::vector<Condition>& all) {
  all.push_back(above("same_sense", "L Omega > 0",
                      "the disc turns with the momentum, so that damping which turns with it calms "
                      "the slow precession",
                      x.L * x.speed, 0.0, "N m s rad/s", Role::kExplains));
  if (const auto top = model::precession(x.tilt, x.speed)) {
    all.push_back(above("faster_than_slow", "|Omega| > slow precession",
                        "the disc overtakes the slow precession, and so calms it",
                        std::abs(x.speed), top->slow, "rad/s", Role::kExplains));
    all.push_back(below("slower_than_fast", "|Omega| < fast precession",
                        "the disc stays behind the fast precession, which it would excite",
                        std::abs(x.speed), top->fast, "rad/s", Role::kExplains));
  }
  const double k = x.between.stiffness, U = x.tilt.U;
  all.push_back(above("stiff_enough", "k_tilt > 3 U",
                      "axles and bushing are stiff enough to carry the structure on the disc", k,
                      3.0 * U, "N m/rad", Role::kExplains));
  all.push_back(below("soft_enough", "k_tilt < 20 U",
                      "axles and bushing give enough to damp (5 to 10 U is a good aim)", k,
                      20.0 * U, "N m/rad", Role::kExplains));
  all.push_back(above("damped_enough", "crot > 0.05 s k_tilt",
                      "enough damping turns with the disc (0.1 to 0.2 s is a good aim)",
                      x.between.rotating_damping, 0.05 * k, "N m s/rad", Role::kExplains));
}

/// @param exact the machine is smooth about its steady motion, so that the tilt equations are its
void add_free(const UmbrellaParameters& p, const Symbols& x, bool exact, Theory& theory) {
  auto& all = theory.conditions;
  Condition tilts = below("tilts", "growth of the tilts < 1e-4 1/s",
                          "structure and disc, as axles and bushing join them, do not depart",
                          x.growth, kNoGrowth, "1/s", decides_if(exact));
  tilts.margin = std::numeric_limits<double>::quiet_NaN();  // a ratio of rates that says nothing
  all.push_back(tilts);
  const double K = x.tilt.U - x.tilt.P;
  if (K <= 0.0) return;  // it hangs
  const Eigen::Vector2d roots = x.tilt.locked_inertia().cwiseSqrt();
  all.push_back(above("sleeping_top", "L^2 > (U - P)(sqrt Jx + sqrt Jy)^2",
                      "the flywheels' and the disc's momentum along its axis carries everything, "
                      "locked together, as a sleeping top",
                      x.L * x.L, K * roots.sum() * roots.sum(), "N^2 m^2 s^2", Role::kExplains));
  if (p.mount == Mount::kUniversalJoint) return add_calming(x, all);
  all.push_back(yes_no("spiral", "cs = 0",
                       "no friction of the ground makes the sleeping top spiral out, against "
                       "which a rigid disc has nothing",
                       x.cs <= 0.0, Role::kExplains));
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
    add_free(p, x, linear && !linear->modes.plant_bends, theory);
  }
  return theory;
}

}  // namespace gyrotwin
