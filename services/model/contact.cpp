#include "services/model/contact.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin::model {

namespace {

// Regularises the direction of the rolling drag at standstill [m^2/s^2].
constexpr double kCreepSquared = 1e-4;

/// Of one side of the track: normal force along `side` * z_S, rolling drag against v_rel.
template <class S>
Vector3<S> force_on(const Track& track, const TipOf<S>& tip, double side, const S& normal) {
  using std::sqrt;
  const Vector3<S> v_t = tip.v_rel - tip.up.dot(tip.v_rel) * tip.up;
  const S drag = track.rolling_drag / sqrt(v_t.squaredNorm() + kCreepSquared);
  return normal * (side * tip.up - drag * v_t);
}

}  // namespace

double contact_energy(const Track& track, const Indentation<double>& indentation) noexcept {
  const double depth = std::max(0.0, indentation.depth);
  return 0.4 * track.stiffness * depth * depth * std::sqrt(depth);
}

template <class S>
Vector3<S> add_contact(const Machine& machine, const MotionOf<S>& motion, const StateOf<S>& state,
                       CoordinatesOf<S>& Q) noexcept {
  const Track& track = *machine.track;
  const int elevation = machine.tree.gimbals().front().coordinate();
  Vector3<S> moment = Vector3<S>::Zero();
  visit_tips(machine, motion, state, [&](const Gyro&, const TipOf<S>& tip) {
    // On the structure at the same point acts the opposite: a pair, for the joint gives neither a
    // velocity against the other.
    const auto add = [&](double side, const S& normal) {
      if (normal <= 0.0) return;
      const Vector3<S> F = force_on(track, tip, side, normal);
      moment += tip.arm.cross(F);
      Q[elevation] += tip.per_angle.dot(F);
    };
    add(+1.0, normal_force(track, tip.lower));
    add(-1.0, normal_force(track, tip.upper));
  });
  return moment;
}

template Vector3<double> add_contact(const Machine&, const Motion&, const State&,
                                     Coordinates&) noexcept;
template Vector3<Dual> add_contact(const Machine&, const MotionOf<Dual>&, const StateOf<Dual>&,
                                   CoordinatesOf<Dual>&) noexcept;

}  // namespace gyrotwin::model
