#include "tests/engine/engine.hpp"

#include <variant>

#include "tests/engine/machines.hpp"

namespace gyrotwin::engine {

namespace {

SimTK::Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vec(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }

std::unique_ptr<Mechanism> mechanism_of(const Rig& rig, const model::State& state) {
  if (const auto* p = std::get_if<model::UmbrellaParameters>(&rig.machine)) {
    return umbrella(*p, state);
  }
  if (const auto* p = std::get_if<model::GimballedParameters>(&rig.machine)) {
    return gimballed(*p, state);
  }
  return gyroscope(std::get<model::GyroscopeParameters>(rig.machine), state);
}

}  // namespace

Found solve(const Rig& rig, const model::State& state, const model::Input& input) {
  const std::unique_ptr<Mechanism> mechanism = mechanism_of(rig, state);
  Plant& plant = mechanism->plant;
  SimTK::State& s = mechanism->state;
  Forces forces(plant, s);
  mechanism->act(forces, input);
  forces.force(plant.structure, mechanism->push_point, vec(input.force));
  forces.moment(plant.structure, vec(input.moment));
  if (rig.load_cell) forces.load_cell(*rig.load_cell);
  forces.apply(s);
  plant.system.realize(s, SimTK::Stage::Acceleration);

  Found found;
  for (std::size_t b = 0; b < plant.bodies.size(); ++b) {
    const SimTK::MobilizedBody& body = plant.bodies[b];
    const SimTK::Vec3 centre = plant.centres[b];
    found.bodies.push_back({vec(body.findStationVelocityInGround(s, centre)),
                            vec(body.getBodyAngularVelocity(s)),
                            vec(body.findStationAccelerationInGround(s, centre)),
                            vec(body.getBodyAngularAcceleration(s))});
  }
  found.angular_momentum = vec(plant.matter.calcSystemMomentumAboutGroundOrigin(s)[0]);
  found.kinetic_energy = plant.matter.calcKineticEnergy(s);
  return found;
}

}  // namespace gyrotwin::engine
