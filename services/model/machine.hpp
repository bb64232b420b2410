// A machine: a gyrostat tree with the forces that act on it. Derivation: README.md, section 3.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "services/model/tree.hpp"

namespace gyrotwin::model {

inline constexpr double kGravity = 9.81;  ///< [m/s^2]
inline constexpr int kMaxDrives = 4;
inline constexpr int kMaxGyros = kMaxRotors;
inline constexpr int kMaxAddedMasses = 4;

/// What changes in time. Entries beyond the machine's coordinates and rotors are 0.
template <class S>
struct StateOf {
  CoordinatesOf<S> q = CoordinatesOf<S>::Zero();  ///< generalised coordinates [rad]
  CoordinatesOf<S> v = CoordinatesOf<S>::Zero();  ///< their rates [rad/s]
  RotorSpeeds rotor_speed{};  ///< relative to the gyro's frame, about its spin axis [rad/s]

  bool finite() const noexcept {
    return q.allFinite() && v.allFinite() &&
           std::all_of(rotor_speed.begin(), rotor_speed.end(),
                       [](double n) { return std::isfinite(n); });
  }
};
using State = StateOf<double>;

/// How Input::drive is meant.
enum class DriveMode : std::uint8_t {
  kTorque,       ///< torque [N m], within the motor line and the torque limit
  kVoltage,      ///< motor voltage [V], within the supply
  kIdealTorque,  ///< torque [N m] from a drive without limits
  kBrake,        ///< motor shorted; without a motor a damping [N m s/rad], within the torque limit
};

/// A mass that rides on the structure without being part of it.
struct PointMass {
  double mass = 0.0;                                   ///< [kg]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< structure frame [m]
};

/// What acts on the machine from outside, healthy drives and rotors unless said otherwise.
struct Input {
  DriveMode mode = DriveMode::kTorque;
  std::array<double, kMaxDrives> drive{};            ///< per drive, unit as in mode
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< world, at the structure's push point [N]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< world, on the structure [N m]

  /// Of the support; world axes, which turn with it [m/s^2].
  Eigen::Vector3d ground_acceleration = Eigen::Vector3d::Zero();
  double yaw_rate = 0.0;  ///< of the support and the world axes about z, steady [rad/s]
  ShortList<PointMass, kMaxAddedMasses> added{};

  std::array<double, kMaxDrives> drive_strength{1, 1, 1, 1};  ///< share of the torque that arrives
  std::array<bool, kMaxGyros> rotor_powered{true, true, true, true};
  std::array<double, kMaxGyros> rotor_brake{};  ///< torque against the spin, at most [N m]
};

/// A DC motor behind a gear; the electrical time constant is neglected.
struct Motor {
  double torque_constant;  ///< Kt [N m/A] = [V s/rad]
  double gear_ratio;       ///< G, motor turns per output turn [1]
  double resistance;       ///< Rm [Ohm]
  double supply_voltage;   ///< Vb [V]

  /// Torque at the output [N m] for a voltage [V] at output speed [rad/s].
  template <class S>
  S torque(double voltage, const S& rate) const noexcept {
    const double k = torque_constant * gear_ratio;
    return k * (voltage - k * rate) / resistance;
  }
  /// The voltage [V] that makes that torque [N m] at that output speed [rad/s].
  double voltage(double torque, double rate) const noexcept {
    const double k = torque_constant * gear_ratio;
    return torque * resistance / k + k * rate;
  }
};

/// A torque that the machine can be commanded: on the disc about z_D with its reaction on the
/// structure, or on a gimbal coordinate.
struct Drive {
  enum class Kind : std::uint8_t { kDisc, kGimbal };
  Kind kind = Kind::kGimbal;
  int coordinate = 0;          ///< the coordinate it turns
  std::optional<Motor> motor;  ///< absent: limited by torque_limit alone, no voltage mode
  double torque_limit;         ///< of the rig [N m]

  /// Lowest and highest torque [N m] it can exert at a rate [rad/s].
  template <class S>
  std::array<S, 2> range(const S& rate) const noexcept;
  /// What it exerts when asked for `command` at a rate [rad/s].
  template <class S>
  S torque(DriveMode mode, double command, const S& rate) const noexcept;
};

/// One-sided springs at both ends of a coordinate, damped while moving further in.
struct Stop {
  int coordinate;
  double lower, upper;  ///< [rad]
  double stiffness;     ///< [N m/rad]
};

/// Outer axles of the gyros on a plane ring fixed in the structure (Hunt-Crossley contact).
struct Track {
  double tip;                       ///< axle tip from the gyro's pivot along its spin axis [m]
  double height;                    ///< of the lower track in the structure's frame [m]
  std::optional<double> clearance;  ///< an upper track this far above the lower one [m]
  double stiffness;                 ///< kc [N/m^1.5]
  double damping;                   ///< cc [s/m]
  double rolling_drag;              ///< mu [1]
};

/// Spring and dampers between disc and structure against relative tilt.
struct TiltBushing {
  double stiffness = 0.0;         ///< k [N m/rad]
  double rotating_damping = 0.0;  ///< fixed in the spinning disc [N m s/rad]
  double standing_damping = 0.0;  ///< fixed in the structure [N m s/rad]
};

/// Friction between disc and structure about z_D: -(viscous w + coulomb tanh(w / kCreep)).
struct DiscFriction {
  static constexpr double kCreep = 0.05;  ///< [rad/s]
  double viscous = 0.0;                   ///< bD [N m s/rad]
  double coulomb = 0.0;                   ///< fcD [N m]
};

/// What keeps the flywheels at speed: a regulated motor each, limited in power and torque, against
/// drag. Off, a rotor coasts down. README.md, section 3.
struct RotorDrive {
  static constexpr double kCreep = 1.0;  ///< over which drag and brake turn [rad/s]
  double power_limit;                    ///< P, of one rotor's motor, mechanical [W]
  double torque_limit;                   ///< [N m]
  double time_constant;                  ///< T of the speed regulator [s]
  double viscous_drag;                   ///< [N m s/rad]
  double coulomb_drag;                   ///< [N m]

  /// tanh(n / kCreep).
  static double sense(double speed) noexcept {
    constexpr double kOne = 20.0 * kCreep;  // from here on tanh is 1 to the last bit
    return std::abs(speed) > kOne ? std::copysign(1.0, speed) : std::tanh(speed / kCreep);
  }
  /// Against the spin, at a speed [rad/s] [N m].
  double drag(double speed) const noexcept {
    return viscous_drag * speed + coulomb_drag * sense(speed);
  }
  /// What the motor exerts when asked for `wanted` [N m] at a speed [rad/s].
  double torque(double wanted, double speed) const noexcept;
};

/// A stiff cell between a point of the structure and the ground, loaded along one direction.
struct LoadCell {
  Eigen::Vector3d point;      ///< structure frame [m]
  Eigen::Vector3d direction;  ///< world, unit: the structure presses on the cell along it
  double stiffness;           ///< [N/m]
  double damping;             ///< [N s/m]
  double rest = 0.0;  ///< where the point is, along the direction, with the cell unloaded [m]
};

/// What an inertial measurement unit on the structure feels; structure axes.
struct InertialReading {
  Eigen::Vector3d angular_velocity;  ///< [rad/s], in space: the support's turning included
  Eigen::Vector3d specific_force;    ///< acceleration minus gravity [m/s^2]
};

/// Where the quantities that people name are among the coordinates; kFixed where a machine has
/// none.
struct Layout {
  struct Gimbal {
    int coordinate = kFixed;
    double coefficient = 1.0;  ///< gimbal angle = coefficient * q[coordinate]
  };
  std::vector<std::string> names;  ///< of the coordinates, as in CSV columns
  std::array<int, 2> tilt{kFixed, kFixed};
  std::array<int, 2> disc_tilt{kFixed, kFixed};
  bool disc_follows_structure = false;  ///< mount `rigid`: the disc's tilt is the structure's
  int disc = kFixed;
  std::vector<Gimbal> gimbals;

  /// Of the structure: 2, 1 on a line, 0 on a stand.
  int tilts() const { return 2 - static_cast<int>(std::count(tilt.begin(), tilt.end(), kFixed)); }
};

/// The platform in the words of the wire; groups a machine lacks are 0. Angles and frames:
/// state_t.lcm.
struct Observation {
  std::array<double, 2> tilt{}, tilt_rate{};                    ///< [rad], [rad/s]
  std::array<double, 2> disc_tilt{}, disc_tilt_rate{};          ///< [rad], [rad/s]
  double disc_angle = 0.0, disc_rate = 0.0;                     ///< [rad], [rad/s]
  std::array<double, kMaxGyros> gimbal_angle{}, gimbal_rate{};  ///< [rad], [rad/s]
  std::array<double, kMaxGyros> rotor_speed{};                  ///< [rad/s]
};

/// What moves and holds a machine.
struct Effort {
  std::array<double, kMaxDrives> drive_torque{};  ///< what arrives of the drives [N m]
  std::array<double, kMaxDrives> drive_margin{};  ///< what they could add in that direction [N m]
  std::array<double, 2>
      holding_moment{};  ///< about x, y, by an external support; mount `level` [N m]
};

/// What no sensor can know.
struct Truth : Effort {
  std::array<double, kMaxGyros> contact_lower{}, contact_upper{};  ///< normal forces [N]
  double kinetic_energy = 0.0;  ///< T2, quadratic in the rates: seen from the support, the rotors'
                                ///< own spin left out [J]
  double potential_energy = 0.0;  ///< gravity and the springs of stops, contact, bushing, cell [J]
  Eigen::Vector3d angular_momentum =
      Eigen::Vector3d::Zero();  ///< about the ground pivot, in space [N m s]
  double gimbal_margin = 0.0;   ///< to the closest stop, < 0 in it [rad]
  double load_cell = 0.0;       ///< > 0: the structure presses on it [N]
};

/// Made by the build() of the parameters of each kind; body 0 is the structure.
struct Machine {
  Tree tree;
  Layout layout;
  double gravity = kGravity;
  RotorSpeeds nominal_rotor_speed{};
  int rotors = 0;
  Eigen::Vector3d push_point = Eigen::Vector3d::Zero();  ///< of Input::force, structure frame [m]
  Coordinates damping = Coordinates::Zero();             ///< viscous, per coordinate [N m s/rad]
  std::vector<Stop> stops{};
  std::vector<Drive> drives{};
  int disc_body = kFixed;  ///< partner of the structure for friction, bushing and disc drive
  DiscFriction disc_friction{};
  TiltBushing bushing{};
  std::optional<Track> track{};             ///< of gimbal 0, on disc_body
  std::optional<RotorDrive> rotor_drive{};  ///< absent: rotors keep their speed, whatever happens
  std::optional<LoadCell> load_cell{};
  /// Mount `level` only: the same bodies with the disc free, which tell the holding moment.
  std::optional<Tree> unheld{};

  int coordinates() const { return tree.coordinates(); }
  /// Nominal rotor speeds at (q, v); missing entries are 0.
  State state(const std::vector<double>& q, const std::vector<double>& v) const;

  /// q'' [rad/s^2]. Not finite where the mass matrix is singular (|thy| = 90 deg). Does not
  /// allocate.
  Coordinates acceleration(const State& state, const Input& input) const noexcept {
    return acceleration(state, input, rotor_acceleration(state, input));
  }
  /// The same where rotor_acceleration() is at hand.
  Coordinates acceleration(const State& state, const Input& input,
                           const RotorSpeeds& rotor_rate) const noexcept;
  /// n' [rad/s^2] of the rotors relative to their frames; 0 without a rotor_drive.
  RotorSpeeds rotor_acceleration(const State& state, const Input& input) const noexcept;
  /// What an IMU at `point` (structure frame [m]) feels.
  InertialReading inertial(const State& state, const Input& input,
                           const Eigen::Vector3d& point) const noexcept;
  /// Rate that drive i works against [rad/s].
  double drive_rate(int drive, const State& state) const noexcept;
  Observation observe(const State& state) const noexcept;
  /// Inverse of observe(); the observation must come from the same machine.
  State recall(const Observation& observation) const noexcept;
  Truth truth(const State& state, const Input& input) const noexcept;
  /// That part of truth(), for less.
  Effort effort(const State& state, const Input& input) const noexcept;
  /// To the closest stop of a gimbal, < 0 in it [rad].
  double gimbal_margin(const State& state) const noexcept;
  /// dL/dq' = M v + rotor momenta, of the machine without added masses on a support at rest:
  /// conserved for coordinates that nothing acts on [N m s].
  Coordinates generalised_momentum(const State& state) const noexcept;
  /// Angle between the structure's axis and the vertical [rad].
  double tilt(const State& state) const noexcept;
};

template <class S>
std::array<S, 2> Drive::range(const S& rate) const noexcept {
  const S limit = torque_limit;
  if (!motor) return {-limit, limit};
  const S low = motor->torque(-motor->supply_voltage, rate);
  const S high = motor->torque(motor->supply_voltage, rate);
  return {std::clamp<S>(low, -limit, limit), std::clamp<S>(high, -limit, limit)};
}

template <class S>
S Drive::torque(DriveMode mode, double command, const S& rate) const noexcept {
  if (mode == DriveMode::kIdealTorque) return command;
  S wanted = command;
  if (mode == DriveMode::kBrake) wanted = motor ? motor->torque(0.0, rate) : S(-command * rate);
  if (mode == DriveMode::kVoltage) {
    if (!motor) return S(0.0);
    const double Vb = motor->supply_voltage;
    wanted = motor->torque(std::clamp(command, -Vb, Vb), rate);
  }
  const auto [low, high] = range(rate);
  return std::clamp<S>(wanted, low, high);
}

}  // namespace gyrotwin::model
