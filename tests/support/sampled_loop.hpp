// A machine held by its law at the rig's rate, contact and limits included, without plant or bus.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "services/controller/law.hpp"

namespace gyrotwin::support {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// One Runge-Kutta step of (q, v); rotors keep their speed.
inline model::State rk4(const model::Machine& machine, const model::State& s,
                        const model::Input& input, double h) {
  const auto moved = [&](const model::State& k, double dt) {
    model::State next = s;
    next.q += dt * k.q;
    next.v += dt * k.v;
    return next;
  };
  const auto slope = [&](const model::State& at) {
    model::State k = at;
    k.q = at.v;
    k.v = machine.acceleration(at, input);
    return k;
  };
  const model::State k1 = slope(s), k2 = slope(moved(k1, h / 2)), k3 = slope(moved(k2, h / 2)),
                     k4 = slope(moved(k3, h));
  model::State next = s;
  next.q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
  next.v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
  return next;
}

/// Loop of a rig's machine, sampled law and stepper.
struct SampledLoop {
  static constexpr int kSubsteps = 10;
  static constexpr double kFallen = 0.7;  // [rad]

  explicit SampledLoop(const Rig& of, const std::vector<double>& q = {},
                       const std::vector<double>& v = {})
      : rig(of), machine(rig.build_machine()), law(rig, machine), state(machine.state(q, v)) {
    law.reset(machine.observe(state));
  }
  SampledLoop(const SampledLoop&) = delete;
  SampledLoop& operator=(const SampledLoop&) = delete;

  /// Runs until `end` [s] or a fall, with a moment on the structure [N m] of time.
  /// @return highest tilt meanwhile [deg]
  double run(double end, const std::function<Eigen::Vector3d(double)>& moment = {}) {
    const double tick = rig.loop.tick_s();
    double highest = 0.0;
    for (; time < end - tick / 2 && tilt_deg() * kDegree < kFallen; time += tick) {
      model::Input input;
      input.drive = law.step(machine.observe(state));
      strongest = std::max(strongest, std::abs(input.drive[0]));
      if (moment) input.moment = moment(time);
      for (int i = 0; i < kSubsteps; ++i) state = rk4(machine, state, input, tick / kSubsteps);
      if (!state.finite()) return std::numeric_limits<double>::quiet_NaN();
      highest = std::max(highest, tilt_deg());
    }
    return highest;
  }

  double tilt_deg() const { return machine.tilt(state) / kDegree; }

  Rig rig;
  model::Machine machine;
  SampledLaw law;
  model::State state;
  double time = 0.0;       // [s]
  double strongest = 0.0;  // torque of the first drive so far [N m]
};

}  // namespace gyrotwin::support
