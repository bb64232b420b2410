#include <cmath>

#include "tests/engine/machines.hpp"
#include "tests/support/umbrella_track.hpp"

namespace gyrotwin::engine {

using SimTK::Inertia;
using SimTK::MassProperties;
using SimTK::MobilizedBody;
using SimTK::Rotation;
using SimTK::Transform;
using SimTK::UnitVec3;
using SimTK::Vec3;

namespace {

class Umbrella : public Mechanism {
 public:
  Umbrella(const model::UmbrellaParameters& parameters, const model::State& start) : p(parameters) {
    add_structure();
    add_disc();
    for (int j = 0; j < p.gyros.count; ++j) {
      add_gyro_unit(j, start.rotor_speed[static_cast<std::size_t>(j)]);
    }
    name_bodies();
    state = plant.system.realizeTopology();
    place(start);
  }

  void act(Forces& forces, const model::Input& input) const override {
    forces.damping(plant.structure, 0, p.structure.damping);
    forces.damping(plant.structure, 1, p.structure.damping);
    forces.damping(plant.leaders[0], 0, p.gyros.damping);
    forces.stop(plant.leaders[0], p.gyros.stop_lower, p.gyros.stop_upper, p.gyros.stop_stiffness);
    forces.disc_friction(p.disc.viscous_friction, p.disc.coulomb_friction);
    forces.bushing(p.bushing);
    const Vec3 axis = plant.disc.getBodyRotation(state).z().asVec3();
    forces.moment_between(plant.disc, plant.structure, input.drive[0] * axis);
    if (p.track != model::TrackKind::kNone) forces.ring(umbrella_track(p));
  }

 private:
  void add_structure() {
    const auto& s = p.structure;
    push_point = Vec3(0, 0, s.cm_height);
    // Its inertias are about the ground pivot, which is its origin.
    const MassProperties properties(s.mass, push_point,
                                    Inertia(s.inertia_x, s.inertia_y, s.inertia_z));
    plant.structure = MobilizedBody::Universal(plant.matter.Ground(), Transform(),
                                               SimTK::Body::Rigid(properties), Transform());
  }

  void add_disc() {
    const double d = p.disc.cm_offset;
    const Inertia central(p.disc.inertia_planar, p.disc.inertia_planar, p.disc.inertia_polar);
    const SimTK::Body::Rigid body(MassProperties(
        p.disc.mass, Vec3(0, 0, d), central.shiftFromMassCenter(Vec3(0, 0, -d), p.disc.mass)));
    const Transform joint(Vec3(0, 0, p.disc.joint_height));
    switch (p.mount) {
      case model::Mount::kRigid:
        plant.disc = MobilizedBody::Pin(plant.structure, joint, body, Transform());
        break;
      case model::Mount::kUniversalJoint:
        plant.disc = MobilizedBody::Ball(plant.structure, joint, body, Transform());
        break;
      case model::Mount::kLevel: {
        // It travels level, and a ball joint closes the loop.
        carrier_ = MobilizedBody::Translation(plant.matter.Ground(), Transform(),
                                              SimTK::Body::Massless(), Transform());
        plant.disc = MobilizedBody::Pin(carrier_, Transform(), body, Transform());
        SimTK::Constraint::Ball(plant.structure, joint.p(), plant.disc, Vec3(0));
      }
    }
  }

  /// Outward, up, and against the tangent: a turn about the last raises the outer end.
  void add_gyro_unit(int j, double speed) {
    const auto& g = p.gyros;
    const double azimuth = 2.0 * SimTK::Pi * j / g.count;
    const Vec3 outward(std::cos(azimuth), std::sin(azimuth), 0);
    const Vec3 against(std::sin(azimuth), -std::cos(azimuth), 0);
    const Transform hinge(
        Rotation(UnitVec3(outward), SimTK::XAxis, UnitVec3(against), SimTK::ZAxis),
        g.pivot_radius * outward + Vec3(0, 0, g.pivot_height));
    const MobilizedBody gyro =
        add_gyro(plant, plant.disc, hinge,
                 {g.mass, g.inertia_axial, g.inertia_transverse, g.rotor_inertia,
                  Vec3(g.cm_distance, 0, 0), SimTK::XAxis, speed});
    if (j == 0) {
      plant.leaders.push_back(gyro);
    } else {
      gear(plant, gyro, plant.leaders[0], 1.0);
    }
  }

  void name_bodies() {
    plant.bodies = {plant.structure, plant.disc};
    plant.centres = {push_point, Vec3(0, 0, p.disc.cm_offset)};
    for (const MobilizedBody& gyro : plant.gyros) {
      plant.bodies.push_back(gyro);
      plant.centres.emplace_back(p.gyros.cm_distance, 0, 0);
    }
  }

  void place(const model::State& start) {
    const bool free = p.mount == model::Mount::kUniversalJoint;
    const int phi = free ? 4 : 2;
    for (int i = 0; i < 2; ++i) {
      plant.structure.setOneQ(state, i, start.q[i]);
      plant.structure.setOneU(state, i, start.v[i]);
    }
    plant.system.realize(state, SimTK::Stage::Velocity);
    if (p.mount == model::Mount::kLevel) place_carrier();
    if (free) {
      place_free_disc(start);
    } else {
      plant.disc.setOneQ(state, 0, start.q[phi]);
      plant.disc.setOneU(state, 0, start.v[phi]);
    }
    for (const MobilizedBody& gyro : plant.gyros) {
      gyro.setOneQ(state, 0, start.q[phi + 1]);
      gyro.setOneU(state, 0, start.v[phi + 1]);
    }
    spin_up();
  }

  /// Where the structure has the disc's joint.
  void place_carrier() {
    const Vec3 joint(0, 0, p.disc.joint_height);
    const Vec3 at = plant.structure.findStationLocationInGround(state, joint);
    const Vec3 v = plant.structure.findStationVelocityInGround(state, joint);
    for (int i = 0; i < 3; ++i) {
      carrier_.setOneQ(state, i, at[i]);
      carrier_.setOneU(state, i, v[i]);
    }
  }

  /// Its angles are against the world, the engine's joint is against the structure.
  void place_free_disc(const model::State& start) {
    const Rotation Rx(start.q[2], SimTK::XAxis), Ry(start.q[3], SimTK::YAxis);
    const Rotation R = Rx * Ry * Rotation(start.q[4], SimTK::ZAxis);
    const Vec3 omega = start.v[2] * Vec3(1, 0, 0) + start.v[3] * (Rx * Vec3(0, 1, 0)) +
                       start.v[4] * (Rx * (Ry * Vec3(0, 0, 1)));
    const Rotation R_S = plant.structure.getBodyRotation(state);
    const Vec3 omega_S = plant.structure.getBodyAngularVelocity(state);
    plant.disc.setQToFitRotation(state, ~R_S * R);
    plant.system.realize(state, SimTK::Stage::Position);
    plant.disc.setUToFitAngularVelocity(state, ~R_S * (omega - omega_S));
  }

  const model::UmbrellaParameters p;
  MobilizedBody carrier_;
};

}  // namespace

std::unique_ptr<Mechanism> umbrella(const model::UmbrellaParameters& p, const model::State& state) {
  return std::make_unique<Umbrella>(p, state);
}

}  // namespace gyrotwin::engine
