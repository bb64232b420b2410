#include "tests/engine/machines.hpp"

namespace gyrotwin::engine {

using SimTK::Inertia;
using SimTK::MassProperties;
using SimTK::MobilizedBody;
using SimTK::Rotation;
using SimTK::Transform;
using SimTK::Vec3;

namespace {

/// `axial` about one axis of the frame, `across` about the two others.
Vec3 moments(const SimTK::CoordinateAxis& axis, double axial, double across) {
  Vec3 all(across);
  all[axis] = axial;
  return all;
}

/// About the body's origin.
MassProperties properties(double mass, const Vec3& cm, const Vec3& central_moments) {
  const Inertia central(central_moments);
  return {mass, cm, central.shiftFromMassCenter(-cm, mass)};
}

}  // namespace

MobilizedBody add_gyro(Plant& plant, MobilizedBody& parent, const Transform& hinge,
                       const GyroUnit& unit) {
  const double Ia = unit.flywheel_inertia;
  const double flywheel_mass = kFlywheelMass * unit.mass;
  const Vec3 frame_moments = moments(unit.spin_axis, unit.inertia_axial - Ia,
                                     unit.inertia_transverse - kFlywheelAcross * Ia);
  MobilizedBody::Pin frame(
      parent, hinge,
      SimTK::Body::Rigid(properties(unit.mass - flywheel_mass, unit.cm, frame_moments)),
      Transform());
  // The flywheel's own frame has its axis along z, as a Pin's is.
  const Transform axle(Rotation(SimTK::UnitVec3(unit.spin_axis), SimTK::ZAxis), unit.cm);
  MobilizedBody::Pin flywheel(
      frame, axle,
      SimTK::Body::Rigid(
          properties(flywheel_mass, Vec3(0), Vec3(kFlywheelAcross * Ia, kFlywheelAcross * Ia, Ia))),
      Transform());
  SimTK::Motion::Steady(flywheel, unit.speed);
  plant.flywheels.emplace_back(flywheel, unit.speed);
  plant.gyros.push_back(frame);
  return frame;
}

void gear(Plant& plant, const MobilizedBody& body, const MobilizedBody& leader, double ratio) {
  const SimTK::Vector coefficients(SimTK::Vec3(1.0, -ratio, 0.0));
  SimTK::Array_<SimTK::MobilizedBodyIndex> bodies;
  bodies.push_back(body.getMobilizedBodyIndex());
  bodies.push_back(leader.getMobilizedBodyIndex());
  SimTK::Array_<SimTK::MobilizerQIndex> angles(2, SimTK::MobilizerQIndex(0));
  SimTK::Constraint::CoordinateCoupler(plant.matter, new SimTK::Function::Linear(coefficients),
                                       bodies, angles);
}

namespace {

class Gimballed : public Mechanism {
 public:
  Gimballed(const model::GimballedParameters& parameters, const model::State& start)
      : p(parameters) {
    const auto& s = p.structure;
    const int gyros = p.arrangement == model::Arrangement::kSingle ? 1
                      : p.arrangement == model::Arrangement::kPair ? 2
                                                                   : 4;
    push_point = Vec3(0, 0, s.cm_height);
    const double central = s.inertia_tilt - s.mass * s.cm_height * s.cm_height;
    const SimTK::Body::Rigid chassis(
        properties(s.mass - gyros * p.gyros.mass, push_point,
                   Vec3(central, central, s.inertia_yaw_ratio * central)));
    if (gyros == 4) {
      plant.structure =
          MobilizedBody::Universal(plant.matter.Ground(), Transform(), chassis, Transform());
    } else {
      const Rotation line(SimTK::UnitVec3(SimTK::XAxis), SimTK::ZAxis);
      plant.structure = MobilizedBody::Pin(plant.matter.Ground(), line, chassis, line);
    }
    add_gyros(gyros, start);
    plant.bodies = {plant.structure};
    plant.centres.assign(1, push_point);
    for (const MobilizedBody& gyro : plant.gyros) {
      plant.bodies.push_back(gyro);
      plant.centres.emplace_back(0);
    }

    state = plant.system.realizeTopology();
    const int tilts = gyros == 4 ? 2 : 1;
    for (int i = 0; i < tilts; ++i) {
      plant.structure.setOneQ(state, i, start.q[i]);
      plant.structure.setOneU(state, i, start.v[i]);
    }
    for (int j = 0; j < gyros; ++j) {
      const double sense = j % 2 == 0 ? 1.0 : -1.0;
      const int coordinate = tilts + j / 2;
      plant.gyros[static_cast<std::size_t>(j)].setOneQ(state, 0, sense * start.q[coordinate]);
      plant.gyros[static_cast<std::size_t>(j)].setOneU(state, 0, sense * start.v[coordinate]);
    }
    spin_up();
  }

  void act(Forces& forces, const model::Input& input) const override {
    for (int i = 0; i < plant.structure.getNumU(state); ++i) {
      forces.damping(plant.structure, i, p.structure.damping);
    }
    for (std::size_t i = 0; i < plant.leaders.size(); ++i) {
      forces.damping(plant.leaders[i], 0, p.gyros.damping);
      forces.stop(plant.leaders[i], -p.gyros.stop, p.gyros.stop, p.gyros.stop_stiffness);
      forces.mobility(plant.leaders[i], 0, input.drive[i]);
    }
  }

 private:
  void add_gyros(int count, const model::State& start) {
    for (int j = 0; j < count; ++j) {
      const double sense = j % 2 == 0 ? 1.0 : -1.0;
      GyroUnit unit{p.gyros.mass,
                    p.gyros.inertia_axial,
                    p.gyros.inertia_transverse,
                    p.gyros.rotor_inertia,
                    Vec3(0),
                    SimTK::CoordinateAxis(j < 2 ? 1 : 0),
                    sense * start.rotor_speed[static_cast<std::size_t>(j)]};
      Transform hinge(push_point);  // gimbal axis z
      if (count == 1) {
        // Gimbal axis y: the frame's z is the chassis' y, its x the chassis' z, where the flywheel
        // turns about.
        hinge.updR() = Rotation(SimTK::UnitVec3(SimTK::YAxis), SimTK::ZAxis,
                                SimTK::UnitVec3(SimTK::ZAxis), SimTK::XAxis);
        unit.spin_axis = SimTK::XAxis;
      }
      const MobilizedBody gyro = add_gyro(plant, plant.structure, hinge, unit);
      if (j % 2 == 0) {
        plant.leaders.push_back(gyro);
      } else {
        gear(plant, gyro, plant.leaders.back(), -1.0);
      }
    }
  }

  const model::GimballedParameters p;
};

class Gyroscope : public Mechanism {
 public:
  Gyroscope(const model::GyroscopeParameters& parameters, const model::State& start)
      : p(parameters) {
    const auto& g = p.gyro;
    push_point = Vec3(g.axle_length, 0, 0);
    // What the post weighs does not matter: its centre of mass stays where it is.
    MobilizedBody::Pin post(plant.matter.Ground(), Transform(),
                            SimTK::Body::Rigid(properties(1.0, Vec3(0), Vec3(g.post_inertia))),
                            Transform());
    plant.disc = post;
    // Raising the tip is a turn about -y.
    const Transform hinge(Rotation(SimTK::UnitVec3(SimTK::NegYAxis), SimTK::ZAxis,
                                   SimTK::UnitVec3(SimTK::XAxis), SimTK::XAxis));
    plant.structure = add_gyro(plant, plant.disc, hinge,
                               {g.mass, g.inertia_axial, g.inertia_transverse, g.rotor_inertia,
                                Vec3(g.cm_distance, 0, 0), SimTK::XAxis, start.rotor_speed[0]});
    plant.bodies = {plant.structure, post};
    plant.centres = {Vec3(g.cm_distance, 0, 0), Vec3(0)};
    state = plant.system.realizeTopology();
    plant.disc.setOneQ(state, 0, start.q[0]);
    plant.disc.setOneU(state, 0, start.v[0]);
    plant.structure.setOneQ(state, 0, start.q[1]);
    plant.structure.setOneU(state, 0, start.v[1]);
    spin_up();
  }

  void act(Forces& forces, const model::Input& input) const override {
    forces.damping(plant.disc, 0, p.gyro.post_damping);
    forces.damping(plant.structure, 0, p.gyro.hinge_damping);
    forces.stop(plant.structure, -p.gyro.stop, p.gyro.stop, p.gyro.stop_stiffness);
    forces.mobility(plant.disc, 0, input.drive[0]);
  }

 private:
  const model::GyroscopeParameters p;
};

}  // namespace

std::unique_ptr<Mechanism> gimballed(const model::GimballedParameters& p,
                                     const model::State& state) {
  return std::make_unique<Gimballed>(p, state);
}

std::unique_ptr<Mechanism> gyroscope(const model::GyroscopeParameters& p,
                                     const model::State& state) {
  return std::make_unique<Gyroscope>(p, state);
}

}  // namespace gyrotwin::engine
