#include "tests/engine/forces.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin::engine {

using SimTK::MobilizedBody;
using SimTK::Vec3;

namespace {

Vec3 vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

Forces::Forces(const Plant& plant, const SimTK::State& state)
    : plant_(plant),
      state_(state),
      on_mobilities_(state.getNU(), 0.0),
      on_bodies_(plant.matter.getNumBodies(), SimTK::SpatialVec(Vec3(0), Vec3(0))) {}

void Forces::apply(SimTK::State& state) const {
  plant_.discrete.setAllMobilityForces(state, on_mobilities_);
  plant_.discrete.setAllBodyForces(state, on_bodies_);
}

void Forces::moment(const MobilizedBody& body, const Vec3& world) {
  plant_.matter.addInBodyTorque(state_, body.getMobilizedBodyIndex(), world, on_bodies_);
}

void Forces::force(const MobilizedBody& body, const Vec3& point, const Vec3& world) {
  plant_.matter.addInStationForce(state_, body.getMobilizedBodyIndex(), point, world, on_bodies_);
}

void Forces::moment_between(const MobilizedBody& body, const MobilizedBody& other,
                            const Vec3& world) {
  moment(body, world);
  moment(other, -world);
}

void Forces::mobility(const MobilizedBody& body, int u, double generalised) {
  plant_.matter.addInMobilityForce(state_, body.getMobilizedBodyIndex(), SimTK::MobilizerUIndex(u),
                                   generalised, on_mobilities_);
}

void Forces::damping(const MobilizedBody& body, int u, double coefficient) {
  mobility(body, u, -coefficient * body.getOneU(state_, u));
}

void Forces::stop(const MobilizedBody& body, double lower, double upper, double stiffness) {
  const double q = body.getOneQ(state_, 0), v = body.getOneU(state_, 0);
  const double d = q > upper ? q - upper : std::min(q - lower, 0.0);
  double moment = stiffness * d;
  if (d * v > 0.0) moment += 0.02 * stiffness * v * std::min(1.0, std::abs(d) / 0.01);
  mobility(body, 0, -moment);
}

double Forces::spin() const {
  const Vec3 w =
      plant_.disc.getBodyAngularVelocity(state_) - plant_.structure.getBodyAngularVelocity(state_);
  return SimTK::dot(w, plant_.disc.getBodyRotation(state_).z().asVec3());
}

void Forces::disc_friction(double viscous, double coulomb) {
  const double w = spin();
  const Vec3 axis = plant_.disc.getBodyRotation(state_).z().asVec3();
  moment_between(plant_.disc, plant_.structure,
                 -(viscous * w + coulomb * std::tanh(w / 0.05)) * axis);
}

void Forces::bushing(const model::TiltBushing& b) {
  const Vec3 z_S = plant_.structure.getBodyRotation(state_).z().asVec3();
  const Vec3 z_D = plant_.disc.getBodyRotation(state_).z().asVec3();
  const Vec3 al = SimTK::cross(z_S, z_D);
  const Vec3 w =
      plant_.disc.getBodyAngularVelocity(state_) - plant_.structure.getBodyAngularVelocity(state_);
  const double omega = SimTK::dot(w, z_D);
  const Vec3 swirl = SimTK::cross(z_D, al);
  const Vec3 ad = w - omega * z_D;
  const Vec3 e = ad - omega * swirl;
  moment_between(plant_.disc, plant_.structure,
                 -b.stiffness * al - b.rotating_damping * e - b.standing_damping * ad +
                     b.rotating_damping * SimTK::dot(e, swirl) * z_D);
}

void Forces::touch(const MobilizedBody& gyro, const Vec3& tip, double side, double depth,
                   double rate, const model::Track& track) {
  if (depth <= 0.0) return;
  const Vec3 at = gyro.findStationLocationInGround(state_, tip);
  const Vec3 on_structure = plant_.structure.findStationAtGroundPoint(state_, at);
  const Vec3 v = gyro.findStationVelocityInGround(state_, tip) -
                 plant_.structure.findStationVelocityInGround(state_, on_structure);
  const Vec3 z_S = plant_.structure.getBodyRotation(state_).z().asVec3();
  const Vec3 along = v - SimTK::dot(v, z_S) * z_S;
  const double normal =
      track.stiffness * std::pow(depth, 1.5) * std::max(0.0, 1.0 + track.damping * rate);
  const double drag = track.rolling_drag * normal / std::sqrt(along.normSqr() + 1e-4);
  const Vec3 total = side * normal * z_S - drag * along;
  force(gyro, tip, total);
  force(plant_.structure, on_structure, -total);
}

void Forces::ring(const model::Track& track) {
  const Vec3 tip(track.tip, 0, 0);
  for (const MobilizedBody& gyro : plant_.gyros) {
    // Seen from the structure, the track is a plane at a height.
    const Vec3 at = gyro.findStationLocationInAnotherBody(state_, tip, plant_.structure);
    const Vec3 v = gyro.findStationVelocityInAnotherBody(state_, tip, plant_.structure);
    touch(gyro, tip, +1.0, track.height - at[2], -v[2], track);
    if (track.clearance) {
      touch(gyro, tip, -1.0, at[2] - track.height - *track.clearance, v[2], track);
    }
  }
}

void Forces::load_cell(const model::LoadCell& cell) {
  const Vec3 point = vec(cell.point), along = vec(cell.direction);
  const Vec3 p = plant_.structure.findStationLocationInGround(state_, point);
  const Vec3 v = plant_.structure.findStationVelocityInGround(state_, point);
  const double N = cell.stiffness * (SimTK::dot(along, p - point) - cell.rest) +
                   cell.damping * SimTK::dot(along, v);
  force(plant_.structure, point, -N * along);
}

}  // namespace gyrotwin::engine
