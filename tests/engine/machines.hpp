// The machines built in Simbody, and put into a state.
#pragma once

#include <memory>

#include "services/runtime/rig.hpp"
#include "tests/engine/forces.hpp"

namespace gyrotwin::engine {

/// A machine in a state, realised to velocities.
class Mechanism {
 public:
  virtual ~Mechanism() = default;
  /// All that the machine's own parts do to each other, and the drives' ideal torques.
  virtual void act(Forces& forces, const model::Input& input) const = 0;

  /// Brings the flywheels to speed.
  void spin_up() {
    for (const auto& [flywheel, speed] : plant.flywheels) flywheel.setOneU(state, 0, speed);
    plant.system.realize(state, SimTK::Stage::Velocity);
  }

  Plant plant;
  SimTK::State state;
  SimTK::Vec3 push_point{0};  ///< of the external force, in the structure
};

std::unique_ptr<Mechanism> umbrella(const model::UmbrellaParameters& p, const model::State& state);
std::unique_ptr<Mechanism> gimballed(const model::GimballedParameters& p,
                                     const model::State& state);
std::unique_ptr<Mechanism> gyroscope(const model::GyroscopeParameters& p,
                                     const model::State& state);

/// The flywheel takes this share of a gyro unit's mass, and this of its axial inertia across.
inline constexpr double kFlywheelMass = 0.3, kFlywheelAcross = 0.55;

/// A gyro's frame as a body on `parent`: turned by its mobilizer's angle about z of `hinge`, which
/// becomes z of its own frame; and in it a flywheel that turns steadily.
struct GyroUnit {
  double mass, inertia_axial, inertia_transverse, flywheel_inertia;
  SimTK::Vec3 cm;                   ///< in the frame [m]
  SimTK::CoordinateAxis spin_axis;  ///< of the frame
  double speed;                     ///< of the flywheel against the frame [rad/s]
};
SimTK::MobilizedBody add_gyro(Plant& plant, SimTK::MobilizedBody& parent,
                              const SimTK::Transform& hinge, const GyroUnit& unit);

/// angle of `body` = ratio * angle of `leader`.
void gear(Plant& plant, const SimTK::MobilizedBody& body, const SimTK::MobilizedBody& leader,
          double ratio);

}  // namespace gyrotwin::engine
