// What acts on the engine's machines: services/model/README.md, section 3, written for Simbody.
#pragma once

#include <Simbody.h>

#include <utility>
#include <vector>

#include "services/model/machine.hpp"

namespace gyrotwin::engine {

/// A system under construction, and the bodies that forces act on.
struct Plant {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::Gravity gravity{forces, matter, -SimTK::ZAxis, model::kGravity};
  SimTK::Force::DiscreteForces discrete{forces, matter};

  SimTK::MobilizedBody structure, disc;      ///< disc: empty where there is none
  std::vector<SimTK::MobilizedBody> bodies;  ///< in the order of the machine's
  std::vector<SimTK::Vec3> centres;          ///< of mass, in those
  std::vector<SimTK::MobilizedBody> gyros;   ///< the frames
  std::vector<std::pair<SimTK::MobilizedBody, double>> flywheels;  ///< and their speeds [rad/s]
  std::vector<SimTK::MobilizedBody> leaders;  ///< whose first angle is a gimbal coordinate
};

/// Collects forces on a state that is realised to velocities, and applies them.
class Forces {
 public:
  Forces(const Plant& plant, const SimTK::State& state);

  /// All of them become the state's.
  void apply(SimTK::State& state) const;

  void moment(const SimTK::MobilizedBody& body, const SimTK::Vec3& world);
  /// At a point of the body, given in its frame.
  void force(const SimTK::MobilizedBody& body, const SimTK::Vec3& point, const SimTK::Vec3& world);
  /// Equal and opposite.
  void moment_between(const SimTK::MobilizedBody& body, const SimTK::MobilizedBody& other,
                      const SimTK::Vec3& world);
  /// On the u-th mobility of a body.
  void mobility(const SimTK::MobilizedBody& body, int u, double generalised);

  void damping(const SimTK::MobilizedBody& body, int u, double coefficient);
  void stop(const SimTK::MobilizedBody& body, double lower, double upper, double stiffness);
  void disc_friction(double viscous, double coulomb);
  void bushing(const model::TiltBushing& bushing);
  void ring(const model::Track& track);
  void load_cell(const model::LoadCell& cell);

 private:
  void touch(const SimTK::MobilizedBody& gyro, const SimTK::Vec3& tip, double side, double depth,
             double rate, const model::Track& track);
  double spin() const;

  const Plant& plant_;
  const SimTK::State& state_;
  SimTK::Vector on_mobilities_;
  SimTK::Vector_<SimTK::SpatialVec> on_bodies_;
};

}  // namespace gyrotwin::engine
