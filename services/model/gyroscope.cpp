#include "services/model/gyroscope.hpp"

#include "services/model/evaluate.hpp"

namespace gyrotwin::model {

namespace {

/// Body x axis: the spin axis, outward. Raising the tip is a turn about -y.
Body axle_body(const GyroscopeParameters::Gyro& g) {
  Body body;
  body.mass = g.mass;
  body.cm = {g.cm_distance, 0.0, 0.0};
  body.inertia = {g.inertia_axial, g.inertia_transverse, g.inertia_transverse};
  body.rotor = {g.rotor_inertia, 0.0, 0.0};
  body.rotor_index = 0;
  return body;
}

Body post_body(const GyroscopeParameters::Gyro& g) {
  Body body;
  body.inertia = {0.0, 0.0, g.post_inertia};
  return body;
}

}  // namespace

Machine build(const GyroscopeParameters& p) {
  Layout layout;
  layout.names = {"psi", "tg"};
  layout.disc = kPrecession;
  layout.gimbals = {{kElevation, 1.0}};

  const GyroscopeParameters::Gyro& g = p.gyro;
  Machine machine{make_tree<kGyroscopeShape>({axle_body(g), post_body(g)}, {}), layout};
  machine.rotors = 1;
  machine.nominal_rotor_speed[0] = g.rotor_speed;
  machine.push_point = {g.axle_length, 0.0, 0.0};
  machine.damping[kPrecession] = g.post_damping;
  machine.damping[kElevation] = g.hinge_damping;
  machine.stops = {{kElevation, -g.stop, g.stop, g.stop_stiffness}};
  machine.drives = {{Drive::Kind::kGimbal, kPrecession, std::nullopt, p.torque_limit}};
  return machine;
}

}  // namespace gyrotwin::model
