#include "clients/analyze/umbrella_symbols.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

namespace {

using model::TrackKind;
using model::UmbrellaParameters;

/// The axles as a spring and a damper that turn with the disc: each on its own, and the moment of
/// the steady forces about the joint, at whose height they do not act.
void add_ring(const UmbrellaParameters& p, double elevation, const model::Truth& truth,
              Symbols& x) {
  const auto& g = p.gyros;
  const double upward = truth.contact_lower[0] - truth.contact_upper[0];
  x.preload = std::abs(upward);
  x.sink = std::pow(x.preload / p.contact.stiffness, 2.0 / 3.0);
  const double radius = g.pivot_radius + g.axle_length * std::cos(elevation);
  const double height = g.pivot_height + g.axle_length * std::sin(elevation);
  const double half = 0.5 * g.count * radius * radius;
  x.between.stiffness +=
      half * 1.5 * p.contact.stiffness * std::sqrt(x.sink) + g.count * upward * height;
  x.between.rotating_damping += half * p.contact.damping * x.preload;
}

}  // namespace

Symbols symbols_of(const Rig& rig, const UmbrellaParameters& p,
                   const std::optional<LinearModel>& linear) {
  const model::Machine machine = rig.build_machine();
  const model::State state = linear ? linear->steady.state : rig.initial_state(machine);
  const double elevation =
      linear ? state.q[machine.layout.gimbals[0].coordinate] : p.gyros.ring_elevation;
  Symbols x{};
  x.r = model::reduce(p);
  x.tilt = model::free_tilt(p, elevation);
  x.between = p.bushing;
  x.b = p.disc.viscous_friction;
  x.cs = p.structure.damping;
  const double KtG = p.drive.motor.torque_constant * p.drive.motor.gear_ratio;
  x.shorted = x.b + KtG * KtG / p.drive.motor.resistance;
  x.no_load = p.drive.motor.supply_voltage / KtG;
  x.speed = state.v[machine.layout.disc];
  x.L = x.tilt.momentum(x.speed);
  x.press = p.track == TrackKind::kSlot ? std::abs(x.r.H * x.speed) : -x.r.H * x.speed;
  if (linear && p.track != TrackKind::kNone) add_ring(p, elevation, machine.truth(state, {}), x);
  x.growth = model::tilt_growth(x.tilt, p.mount, x.between, x.cs, x.speed);
  x.carried = model::tilt_growth(x.tilt, p.mount, p.bushing, x.cs, x.speed) < kNoGrowth;
  return x;
}

}  // namespace gyrotwin
