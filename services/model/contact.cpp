#include "services/model/contact.hpp"

#include <cmath>

namespace gyrotwin::model {

namespace {

// Regularises the direction of the rolling drag at standstill [m^2/s^2].
constexpr double kCreepSquared = 1e-4;

/// Row by row.
template <class S>
PerGyro<S> dot(const VectorPerGyro<S>& a, const Vector3<S>& b) {
  return a.col(0) * b[0] + a.col(1) * b[1] + a.col(2) * b[2];
}

/// Normal force along `side` * z_S, rolling drag against v_rel.
template <class S>
VectorPerGyro<S> force_on(const Track& track, const TipsOf<S>& tips, const Vector3<S>& z_S,
                          double side, const PerGyro<S>& normal) {
  const PerGyro<S> along = dot(tips.v_rel, z_S);
  VectorPerGyro<S> v_t;
  for (int i = 0; i < 3; ++i) v_t.col(i) = tips.v_rel.col(i) - along * z_S[i];
  const PerGyro<S> speed_squared = v_t.col(0).square() + v_t.col(1).square() + v_t.col(2).square();
  const PerGyro<S> drag = track.rolling_drag * normal / (speed_squared + kCreepSquared).sqrt();
  VectorPerGyro<S> force;
  for (int i = 0; i < 3; ++i) force.col(i) = normal * (side * z_S[i]) - drag * v_t.col(i);
  return force;
}

}  // namespace

template <class S>
TipsOf<S> tips_of(const Machine& machine, const DiscMotionOf<S>& disc, const MotionOf<S>& motion,
                  const StateOf<S>& state) noexcept {
  const Track& track = *machine.track;
  const Gimbal& gimbal = machine.tree.gimbals()[0];
  const int k = machine.tree.shape().gimbals[0].coordinate;
  const double height = track.height - machine.tree.bodies()[machine.disc_body].pivot.z();
  const S lc = track.tip * motion.cos_q[k], ls = track.tip * motion.sin_q[k];
  const Vector3<S> z_S = disc.R.row(2).transpose();
  const Vector3<S>& w = disc.omega;

  TipsOf<S> tips;
  tips.arm = gimbal.pivots() + lc * gimbal.axes() + ls * gimbal.raised_axes();
  tips.per_angle = lc * gimbal.raised_axes() - ls * gimbal.axes();
  for (int x = 0; x < 3; ++x) {
    const int y = (x + 1) % 3, z = (x + 2) % 3;
    tips.v_rel.col(x) =
        w[y] * tips.arm.col(z) - w[z] * tips.arm.col(y) + state.v[k] * tips.per_angle.col(x);
  }
  tips.lower = {height - dot(tips.arm, z_S), -dot(tips.v_rel, z_S)};
  const int missing = kMaxRotors - static_cast<int>(gimbal.gyros().size());
  tips.lower.depth.tail(missing).setConstant(S(-1.0));
  tips.upper.depth.setConstant(S(-1.0));
  tips.upper.rate = -tips.lower.rate;
  if (track.clearance) {
    tips.upper.depth = -tips.lower.depth - *track.clearance;
    tips.upper.depth.tail(missing).setConstant(S(-1.0));
  }
  return tips;
}

template <class S>
PerGyro<S> normal_force(const Track& track, const IndentationOf<S>& in) noexcept {
  const PerGyro<S> none = PerGyro<S>::Zero();
  const PerGyro<S> depth = (in.depth > 0.0).select(in.depth, none);
  const PerGyro<S> damped = 1.0 + track.damping * in.rate;
  const PerGyro<S> force =
      track.stiffness * depth * depth.sqrt() * (damped > 0.0).select(damped, none);
  return (in.depth > 0.0).select(force, none);
}

double contact_energy(const Track& track, const IndentationOf<double>& in) noexcept {
  const PerGyro<double> depth = in.depth.max(0.0);
  return 0.4 * track.stiffness * (depth * depth * depth.sqrt()).sum();
}

template <class S>
Vector3<S> add_contact(const Machine& machine, const DiscMotionOf<S>& disc,
                       const MotionOf<S>& motion, const StateOf<S>& state,
                       CoordinatesOf<S>& Q) noexcept {
  const Track& track = *machine.track;
  const TipsOf<S> tips = tips_of(machine, disc, motion, state);
  const Vector3<S> z_S = disc.R.row(2).transpose();
  Vector3<S> moment = Vector3<S>::Zero();
  // On the structure at the same point acts the opposite: a pair, for at the joint neither moves
  // against the other.
  const auto add = [&](double side, const IndentationOf<S>& in) {
    if (!(in.depth > 0.0).any()) return;
    const auto F = force_on(track, tips, z_S, side, normal_force(track, in));
    Q[machine.tree.shape().gimbals[0].coordinate] += (tips.per_angle * F).sum();
    for (int x = 0; x < 3; ++x) {
      const int y = (x + 1) % 3, z = (x + 2) % 3;
      moment[x] += (tips.arm.col(y) * F.col(z) - tips.arm.col(z) * F.col(y)).sum();
    }
  };
  add(+1.0, tips.lower);
  if (track.clearance) add(-1.0, tips.upper);
  return moment;
}

template TipsOf<double> tips_of(const Machine&, const DiscMotionOf<double>&, const Motion&,
                                const State&) noexcept;
template PerGyro<double> normal_force(const Track&, const IndentationOf<double>&) noexcept;
template Vector3<double> add_contact(const Machine&, const DiscMotionOf<double>&, const Motion&,
                                     const State&, Coordinates&) noexcept;
template Vector3<Dual> add_contact(const Machine&, const DiscMotionOf<Dual>&, const MotionOf<Dual>&,
                                   const StateOf<Dual>&, CoordinatesOf<Dual>&) noexcept;

}  // namespace gyrotwin::model
