#include "clients/analyze/steady_motion.hpp"

#include <Eigen/QR>
#include <cmath>

#include "clients/analyze/loop.hpp"

namespace gyrotwin {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSteady = 1e-7;  // a residual below it is rounding [rad/s^2]
constexpr int kNewtonSteps = 60;

/// Where the gimbals rest while the disc turns as it does: the first place, from the lower stop up,
/// where their acceleration passes from up to down.
void rest_gimbal(const Loop& loop, const model::Stop& stop, model::State& state) {
  constexpr int kPlaces = 4000;
  constexpr double kBeyond = 0.2;  // a stop's spring may be pressed [rad]
  const double low = stop.lower - kBeyond;
  const double high = stop.upper + kBeyond;
  const auto pull = [&](double angle) {
    model::State there = state;
    there.q[stop.coordinate] = angle;
    return loop.acceleration(there, LawState::Zero())[stop.coordinate];
  };
  const double start = state.q[stop.coordinate];
  if (std::abs(pull(start)) < kSteady) return;
  double below = low;
  for (int i = 1; i <= kPlaces; ++i) {
    double above = low + (high - low) * i / kPlaces;
    if (pull(below) > 0.0 && pull(above) <= 0.0) {
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = 0.5 * (below + above);
        (pull(middle) > 0.0 ? below : above) = middle;
      }
      state.q[stop.coordinate] = 0.5 * (below + above);
      return;
    }
    below = above;
  }
}

/// Upright, gimbals at rest, the disc at the speed that the law seeks or the rig starts with.
model::State first_guess(const Rig& rig, const model::Machine& machine, const Loop& loop) {
  model::State state = rig.initial_state(machine);
  state.v.setZero();
  state.rotor_speed = machine.nominal_rotor_speed;
  for (int i = 0; i < 2; ++i) {
    if (machine.layout.tilt[i] != model::kFixed) state.q[machine.layout.tilt[i]] = 0.0;
    if (machine.layout.disc_tilt[i] != model::kFixed) state.q[machine.layout.disc_tilt[i]] = 0.0;
  }
  if (loop.cyclic() != model::kFixed) {
    const bool sought = rig.controller.law != LawKind::kNone && rig.controller.disc_speed;
    state.v[loop.cyclic()] =
        sought ? -*rig.controller.disc_speed : rig.initial_state(machine).v[loop.cyclic()];
  } else {
    for (const model::Stop& stop : machine.stops) state.q[stop.coordinate] = 0.0;
  }
  const Loop undriven(machine, nullptr);
  if (loop.cyclic() != model::kFixed) {
    for (const model::Stop& stop : machine.stops) rest_gimbal(undriven, stop, state);
  }
  return state;
}

/// The unknowns of a steady motion: positions, the cyclic coordinate's rate, the law's memory.
struct Unknowns {
  const Loop& loop;
  const model::State& like;
  bool speed;  // the cyclic rate is one of them

  VectorXd pack(const model::State& state, const LawState& z) const {
    VectorXd u(std::ssize(loop.positions()) + (speed ? 1 : 0) + loop.memory_size());
    Eigen::Index k = 0;
    for (const int i : loop.positions()) u[k++] = state.q[i];
    if (speed) u[k++] = state.v[loop.cyclic()];
    for (Eigen::Index i = 0; i < loop.memory_size(); ++i) u[k++] = z[i];
    return u;
  }
  void unpack(const VectorXd& u, model::State& state, LawState& z) const {
    state = like;
    z = LawState::Zero();
    Eigen::Index k = 0;
    for (const int i : loop.positions()) state.q[i] = u[k++];
    if (speed) state.v[loop.cyclic()] = u[k++];
    for (Eigen::Index i = 0; i < loop.memory_size(); ++i) z[i] = u[k++];
  }
  VectorXd residual(const VectorXd& u) const {
    model::State state;
    LawState z;
    unpack(u, state, z);
    const model::Coordinates a = loop.acceleration(state, z);
    const LawState rate = loop.memory_rate(state, z);
    VectorXd r(u.size());
    Eigen::Index k = 0;
    for (const int i : loop.positions()) r[k++] = a[i];
    if (speed) r[k++] = a[loop.cyclic()];
    for (Eigen::Index i = 0; i < loop.memory_size(); ++i) r[k++] = rate[i];
    return r;
  }
};

/// Newton's method, steps halved until they help.
void solve(const Unknowns& unknowns, VectorXd& u) {
  VectorXd r = unknowns.residual(u);
  for (int step = 0; step < kNewtonSteps && r.norm() > 1e-12; ++step) {
    const MatrixXd J = slopes([&](const VectorXd& x) { return unknowns.residual(x); }, u);
    if (!J.allFinite()) return;
    const VectorXd whole = -J.completeOrthogonalDecomposition().solve(r);
    double share = 1.0;
    VectorXd next, there;
    do {
      next = u + share * whole;
      there = unknowns.residual(next);
      share *= 0.5;
    } while (share > 1e-6 && !(there.norm() < r.norm()));
    if (!(there.norm() < r.norm())) return;
    u = next;
    r = there;
  }
}

}  // namespace

SteadyMotion steady_motion(const Rig& rig, const model::Machine& machine, const Law* law) {
  const Loop loop(machine, law);
  SteadyMotion steady;
  const model::State guess = first_guess(rig, machine, loop);
  if (law != nullptr) steady.memory = law->start(machine.observe(guess));
  steady.coasts = law == nullptr && loop.cyclic() != model::kFixed;

  const Unknowns unknowns{loop, guess, loop.cyclic() != model::kFixed && !steady.coasts};
  VectorXd u = unknowns.pack(guess, steady.memory);
  solve(unknowns, u);
  unknowns.unpack(u, steady.state, steady.memory);
  steady.torque = loop.torque(steady.state, steady.memory);
  steady.residual = unknowns.residual(u).cwiseAbs().maxCoeff();
  steady.found = steady.residual < kSteady;
  return steady;
}

}  // namespace gyrotwin
