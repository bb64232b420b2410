// A rig that is not quite its model, its law, and the twin that follows it, without owner or bus.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "services/controller/law.hpp"
#include "services/integrator/plant.hpp"
#include "services/integrator/schedule.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/mirror/follower.hpp"
#include "services/mirror/health.hpp"
#include "services/onboard/estimator.hpp"
#include "services/runtime/rig.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin::support {

struct TwinBench {
  using Overrides = std::vector<std::string>;

  /// @param of_rig what the rig has otherwise than its file, unknown to the twin
  /// @param of_both what both have otherwise
  explicit TwinBench(const std::string& name, Overrides of_rig = {}, const Overrides& of_both = {})
      : rig(load_rig(name, of_both)),
        machine(rig.build_machine()),
        real_rig(load_rig(name, joined(of_both, std::move(of_rig)))),
        real(real_rig.build_machine()),
        plant(real, real_rig.loop.tick_s(), {.substeps = real_rig.loop.substeps}),
        simulated(real_rig, real),
        schedule(real_rig, real),
        law(rig, machine),
        estimator(rig, machine),
        follower(rig, machine),
        health(rig, machine) {
    plant.set_state(real_rig.initial_state(real));
    law.reset(real.observe(plant.state()));
    estimator.reset(real.observe(plant.state()));
    look();
    follower.start(sensors);
  }

  /// A disturbance or a fault from now on. @return whether the schedule takes it
  bool ask(request_t request, std::int32_t verb) {
    request.verb = verb;
    reply_t reply{};
    return schedule.add(request, tick, reply) && reply.result == reply_t::APPLIED;
  }
  bool fault(std::int32_t kind, std::int32_t target, double level = 0.0, double delay_s = 0.0) {
    request_t request{};
    request.kind = kind;
    request.target = target;
    request.level = level;
    request.delay_ns = std::llround(1e9 * delay_s);
    return ask(request, request_t::FAULT);
  }
  /// The rig's reference impulse about x, times `share`.
  bool push(double share = 1.0) {
    request_t request{};
    request.kind = request_t::LOAD;
    request.moment_nm[0] = share * rig.reference_impulse_nms / rig.impulse_duration_s;
    request.duration_ns = std::llround(1e9 * rig.impulse_duration_s);
    return ask(request, request_t::DISTURB);
  }

  /// One tick of rig and twin. @return false when the solver failed
  bool step() {
    model::Input input;
    input.drive = law.step(rig.loop.state == StateSource::kEstimate ? estimator.seen()
                                                                    : real.observe(plant.state()));
    commanded = input;
    schedule.apply(tick, input);
    if (disturb) disturb(*this, input);
    if (!plant.advance(input)) return false;
    acting = input;
    ++tick;
    look();
    estimator.step(sensors);
    follower.step(sensors, commanded);
    health.take(follower, sensors, commanded);
    follower.distrust(health.distrusted());
    health.fill(said);
    return true;
  }
  /// @return false when the solver failed
  bool run(double seconds) {
    const std::int64_t end = tick + std::llround(seconds * rig.loop.rate_hz);
    while (tick < end) {
      if (!step()) return false;
    }
    return true;
  }
  /// Runs until the twin says so, `limit` [s] at most. @return the time it took [s]; < 0: never
  double run_until(const std::function<bool(const health_t&)>& says, double limit) {
    const std::int64_t begin = tick, end = tick + std::llround(limit * rig.loop.rate_hz);
    while (tick < end) {
      if (!step()) return -1.0;
      if (says(said)) return static_cast<double>(tick - begin) * rig.loop.tick_s();
    }
    return -1.0;
  }

  /// Errors of (q, v).
  Eigen::VectorXd error() const {
    const int n = machine.coordinates();
    Eigen::VectorXd e(2 * n);
    e << (follower.estimate().state.q - plant.state().q).head(n),
        (follower.estimate().state.v - plant.state().v).head(n);
    return e;
  }
  /// Normalised estimation error squared; mean: the follower's dimension.
  double nees() const {
    return follower.deviation().triangularView<Eigen::Lower>().solve(error()).squaredNorm();
  }
  std::string text() const { return get_text(said.text); }
  double time() const { return static_cast<double>(tick) * rig.loop.tick_s(); }

  Rig rig;
  model::Machine machine;
  Rig real_rig;
  model::Machine real;
  Plant plant;
  SimulatedSensors simulated;
  Schedule schedule;
  SampledLaw law;
  OnboardEstimator estimator;
  Follower follower;
  Health health;
  std::function<void(TwinBench&, model::Input&)> disturb;  // what no request can ask for
  sensors_t sensors{};
  model::Input acting, commanded;
  health_t said{};
  std::int64_t tick = 0;

 private:
  static Overrides joined(Overrides a, const Overrides& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  void look() {
    simulated.measure(tick, plant.state(), acting, real.truth(plant.state(), acting), sensors);
    sensors.header.tick = tick;
    schedule.corrupt(tick, sensors);
  }
};

}  // namespace gyrotwin::support
