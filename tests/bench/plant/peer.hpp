// The same machine in somebody's engine, put into states and asked for its accelerations.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/plant/mechanism.hpp"

namespace gyrotwin::bench {

/// A state and what acts there: ideal torques of the drives, and a moment on the structure.
struct Sample {
  model::State state;
  model::Input input;
};

class Peer {
 public:
  virtual ~Peer() = default;
  /// As in figures: "MuJoCo".
  virtual std::string name() const = 0;
  /// Translates samples to the engine's own coordinates, which is not timed.
  virtual void load(const std::vector<Sample>& samples) = 0;
  /// Puts the machine into sample i and works out its accelerations: what is timed.
  virtual void evaluate(std::size_t i) = 0;
  /// The model's q'' [rad/s^2] as the last evaluate() found it.
  virtual model::Coordinates acceleration() const = 0;
};

/// The model itself, flywheels at steady speed.
std::unique_ptr<Peer> gyrotwin_peer(const Rig& rig);
/// The model as the rig has it, its flywheels' drives included.
std::unique_ptr<Peer> gyrotwin_with_rotor_drives(const Rig& rig);

/// Gears as joint equality constraints, accelerations by mj_forward().
std::unique_ptr<Peer> mujoco_peer(const Rig& rig);
/// Gears by projection of what MuJoCo's kinematics, inertia and bias give.
std::unique_ptr<Peer> mujoco_projected_peer(const Rig& rig);
/// Gears by projection too.
std::unique_ptr<Peer> dart_peer(const Rig& rig);
std::unique_ptr<Peer> simbody_peer(const Rig& rig);

}  // namespace gyrotwin::bench
