// Plant, sensors, estimator and law in one loop, without owner, bus or clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "services/controller/law.hpp"
#include "services/integrator/plant.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/onboard/estimator.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin::support {

/// What a stretch of a run was like.
struct Figures {
  double peak_deg = 0.0;    ///< largest tilt
  double rms_deg = 0.0;     ///< of the tilt
  double torque_rms = 0.0;  ///< of the drives' torques about their means [N m]
  double error_deg = 0.0;   ///< rms of the estimated tilt's error
  double error_peak_deg = 0.0;
};

struct EstimatedLoop {
  /// The law sees the estimate where the rig says so, else the truth.
  explicit EstimatedLoop(const std::string& name, const std::vector<std::string>& overrides = {})
      : rig(load_rig(name, overrides)),
        machine(rig.build_machine()),
        plant(machine, rig.loop.tick_s(), {.substeps = rig.loop.substeps}),
        simulated(rig, machine),
        estimator(rig, machine),
        law(rig, machine) {
    plant.set_state(rig.initial_state(machine));
    estimator.reset(machine.observe(plant.state()));
    law.reset(machine.observe(plant.state()));
  }

  /// One tick: sensors, estimate, law, plant. @return false when the solver failed
  bool tick() {
    truth = machine.observe(plant.state());
    simulated.measure(ticks, plant.state(), input, machine.truth(plant.state(), input), sensors);
    corrupt(sensors);
    estimator.step(sensors);
    const bool by_estimate = rig.loop.state == StateSource::kEstimate;
    input = {};
    input.drive = law.step(by_estimate ? estimator.seen() : truth);
    if (ticks < push_until) input.moment.x() = rig.reference_impulse_nms / rig.impulse_duration_s;
    ++ticks;
    return plant.advance(input);
  }

  /// The rig's reference impulse, from the next tick.
  void push() { push_until = ticks + std::llround(rig.impulse_duration_s * rig.loop.rate_hz); }

  Figures run(double seconds) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    Figures f;
    const auto n = std::llround(seconds * rig.loop.rate_hz);
    std::array<double, 2> sum{}, squares{};
    for (std::int64_t k = 0; k < n; ++k) {
      if (!tick()) {
        f.peak_deg = HUGE_VAL;
        return f;
      }
      const double tilt = machine.tilt(plant.state()) * kDegrees;
      f.peak_deg = std::max(f.peak_deg, tilt);
      f.rms_deg += tilt * tilt / static_cast<double>(n);
      for (std::size_t i = 0; i < 2; ++i) {
        sum[i] += input.drive[i];
        squares[i] += input.drive[i] * input.drive[i];
      }
      const double error = tilt_error() * kDegrees;
      f.error_deg += error * error / static_cast<double>(n);
      f.error_peak_deg = std::max(f.error_peak_deg, error);
      if (tilt > 60.0) return f;
    }
    f.rms_deg = std::sqrt(f.rms_deg);
    f.error_deg = std::sqrt(f.error_deg);
    for (std::size_t i = 0; i < 2; ++i) {
      const double mean = sum[i] / static_cast<double>(n);
      f.torque_rms += squares[i] / static_cast<double>(n) - mean * mean;
    }
    f.torque_rms = std::sqrt(std::max(0.0, f.torque_rms));
    return f;
  }

  /// Of what was estimated in the last tick, against the state then [rad].
  double tilt_error() const {
    return std::hypot(estimator.seen().tilt[0] - truth.tilt[0],
                      estimator.seen().tilt[1] - truth.tilt[1]);
  }

  Rig rig;
  model::Machine machine;
  Plant plant;
  SimulatedSensors simulated;
  OnboardEstimator estimator;
  SampledLaw law;
  std::function<void(sensors_t&)> corrupt = [](sensors_t&) {};
  sensors_t sensors{};
  model::Input input;
  model::Observation truth;  // of the last tick, when the sensors looked
  std::int64_t ticks = 0, push_until = 0;
};

}  // namespace gyrotwin::support
