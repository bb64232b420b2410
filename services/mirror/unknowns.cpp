#include "services/mirror/unknowns.hpp"

#include <cmath>

namespace gyrotwin {

namespace {

/// What a rig's unknowns are measured by.
struct Scales {
  double toppling;   ///< U [N m/rad]
  double tilting;    ///< A [kg m^2]
  double structure;  ///< the structure's own tilt inertia [kg m^2]; 0: it does not tilt
};

Scales scales_of(const model::UmbrellaParameters& p) {
  const auto r = model::reduce(p);
  return {r.U, r.A, p.structure.inertia_x};
}
Scales scales_of(const model::GimballedParameters& p) {
  const auto r = model::reduce(p);
  return {r.U, r.A, p.structure.inertia_tilt};
}
Scales scales_of(const model::GyroscopeParameters& p) {
  const auto& g = p.gyro;
  return {model::kGravity * g.mass * g.cm_distance, g.inertia_transverse, 0.0};
}

// Time constants [s]: faults stay, biases drift with the temperature.
constexpr double kFault = 60.0, kBias = 1000.0;
// A moment that nothing shows is not believed in for longer.
constexpr double kMoment = 2.0;

}  // namespace

Unknowns::Unknowns(const Rig& rig, const model::Machine& machine)
    : coordinates(machine.coordinates()) {
  const Scales scales = std::visit([](const auto& p) { return scales_of(p); }, rig.machine);
  const Rig::Mirror& mirror = rig.mirror;
  const Rig::Sensors& sensors = *rig.sensors;
  structure_inertia = scales.structure;
  toppling_rate = scales.toppling / scales.tilting;

  const auto place = [this](double sigma, double time_constant) {
    prior[size] = sigma;
    forget[size] = 1.0 / time_constant;
    walk[size] = sigma * std::sqrt(2.0 / time_constant);
    slow[size] = true;
    return size++;
  };
  const auto walking = [this](double sigma, double per_root_second) {
    prior[size] = sigma;
    walk[size] = per_root_second;
    return size++;
  };

  size = 2 * coordinates;
  for (int i = 0; i < coordinates; ++i) {
    walk[coordinates + i] = mirror.model_noise * toppling_rate;
  }
  for (int i = 0; i < 2; ++i) {
    if (machine.layout.tilt[i] == model::kFixed) continue;
    moment[i] = walking(mirror.moment_walk * scales.toppling, mirror.moment_walk * scales.toppling);
    forget[moment[i]] = 1.0 / kMoment;
  }
  if (machine.disc_body != model::kFixed) {
    const double limit = machine.drives[0].torque_limit;
    friction = walking(10.0 * mirror.friction_walk * limit, mirror.friction_walk * limit);
  }
  if (scales.structure > 0.0 && mirror.inertia_spread > 0.0) {
    inertia = place(mirror.inertia_spread, kFault);
  }
  for (std::size_t i = 0; mirror.drive_spread > 0.0 && i < machine.drives.size(); ++i) {
    strength[i] = place(mirror.drive_spread, kFault);
  }
  dynamic = size;

  for (int& i : gyro_bias) i = place(sensors.gyro.bias, kBias);
  for (int& i : accelerometer_bias) i = place(sensors.acceleration.bias, kBias);
  if (machine.layout.disc != model::kFixed) disc_bias = place(sensors.disc.bias, kBias);
  for (std::size_t j = 0; j < machine.layout.gimbals.size(); ++j) {
    gimbal_bias[j] = place(sensors.gimbal.bias, kBias);
  }
  for (std::size_t i = 0; i < machine.drives.size(); ++i) {
    if (machine.drives[i].motor) current_bias[i] = place(sensors.current.bias, kBias);
  }
  if (machine.load_cell) load_cell_bias = place(sensors.load_cell.bias, kBias);
}

}  // namespace gyrotwin
