// A rig file: one TOML file that configures every daemon and client of one platform.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/model/gimballed.hpp"
#include "services/model/gyroscope.hpp"
#include "services/model/umbrella.hpp"

namespace gyrotwin {

enum class ClockMode : std::uint8_t { kRealtime, kLockstep, kFree };
enum class OverrunPolicy : std::uint8_t { kSkip, kStop };
enum class SafeStopDrive : std::uint8_t { kZeroTorque, kBrake, kHoldSpeed };
enum class StateSource : std::uint8_t { kTruth, kEstimate };
enum class Wave : std::uint8_t { kSine, kRelay };
enum class LawKind : std::uint8_t {
  kNone,
  kOpenLoop,
  kConstantSpeed,
  kTiltToSpeed,
  kMomentumManager,
  kReducedLqr,
  kPrecession,
  kShelf,
  kPrecessionLqr
};

/// How one kind of sensor departs from the truth, in the sensor's unit.
struct Imperfection {
  double noise = 0.0;       ///< standard deviation of one sample
  double bias = 0.0;        ///< standard deviation of what each sensor is off by, drawn once
  double resolution = 0.0;  ///< step of what is told; 0: none
};

/// Everything a rig file says, checked. Keys in the file are these names with units.
struct Rig {
  std::filesystem::path file;
  std::string name;     ///< rig.name
  std::string summary;  ///< rig.summary, one sentence
  int id = 0;           ///< rig.id

  struct Network {
    std::string prefix;     ///< channel prefix, `[A-Z0-9_]+`
    std::string group;      ///< IPv4 multicast group
    int port = 0;           ///< UDP port
    std::string interface;  ///< name of the network interface, `lo` for this host
    int ttl = 0;            ///< 0: this host only, 1: this subnet
    bool sign = true;       ///< every message signed and checked
  } network;

  struct Loop {
    ClockMode clock = ClockMode::kRealtime;
    double rate_hz = 1000.0;       ///< ticks per second of the owner's time
    int substeps = 4;              ///< of the stepper per tick
    double step_tolerance = 1e-4;  ///< largest error of q over the check at start [rad]
    static constexpr int kMaxCommandDelay = 8;
    int command_delay_ticks = 0;  ///< a command acts this many ticks later
    OverrunPolicy overrun = OverrunPolicy::kSkip;
    StateSource state = StateSource::kTruth;  ///< what a simulated owner publishes as STATE
    double patience_s = 0.1;  ///< realtime: simulated time may stand still that long for a command
    static constexpr int kMaxSpin = 300;
    int spin_us = 0;  ///< the end of a simulated owner's sleep that is spun through [us]
    std::int64_t tick_ns() const { return std::llround(1e9 / rate_hz); }
    std::int64_t patience_ns() const { return std::llround(1e9 * patience_s); }
    double tick_s() const { return 1e-9 * static_cast<double>(tick_ns()); }
  } loop;

  struct Safety {
    int command_timeout_ticks = 10;  ///< without a valid command, then SAFE_STOP; 1 to 10
    double fall_tilt_rad = 0.7;      ///< beyond it: FALLEN
    SafeStopDrive drive = SafeStopDrive::kZeroTorque;
    /// kHoldSpeed: torque per speed error; kBrake without a motor: damping [N m s/rad]
    double gain = 0.0;
  } safety;

  std::variant<model::UmbrellaParameters, model::GimballedParameters, model::GyroscopeParameters>
      machine;
  std::optional<model::RotorDrive> rotor_drive;  ///< absent: rotors keep their speed
  std::optional<model::LoadCell> load_cell;      ///< holds the structure

  /// [wind]: what the air gets hold of.
  struct Wind {
    static constexpr double kAirDensity = 1.225;  ///< [kg/m^3]
    double area;                                  ///< [m^2]
    double drag_coefficient;                      ///< [1]
    double pressure_height;  ///< of the centre of pressure above the ground pivot [m]
  };
  std::optional<Wind> wind;  ///< absent: no wind can be applied

  /// [sensors]: what the rig measures and how badly.
  struct Sensors {
    Eigen::Vector3d imu_position = Eigen::Vector3d::Zero();  ///< structure frame [m]
    Eigen::Vector3d imu_orientation =
        Eigen::Vector3d::Zero();  ///< structure <- IMU: Rx Ry Rz [rad]
    Imperfection gyro;            ///< [rad/s]
    Imperfection acceleration;    ///< [m/s^2]
    Imperfection disc;            ///< [rad]
    Imperfection gimbal;          ///< [rad]
    Imperfection rotor;           ///< [rad/s]
    Imperfection current;         ///< [A]
    Imperfection voltage;         ///< [V]
    Imperfection load_cell;       ///< [N]
    static constexpr int kMaxDelay = 8;
    int delay_ticks = 0;               ///< of all of them
    int seed = 1;                      ///< of noise and biases
    Eigen::Matrix3d imu_axes() const;  ///< structure <- IMU
  };
  std::optional<Sensors> sensors;  ///< absent: no SENSORS, no estimate

  /// [estimator]: bandwidths of the onboard estimator.
  struct Estimator {
    double tilt = 1.0;       ///< of the accelerometer's correction of the integrated gyro [rad/s]
    double gyro_bias = 0.1;  ///< of learning the gyro's bias [rad/s]
    double disc = 200.0;     ///< of the disc rate from its encoder [rad/s]
    double gimbal = 400.0;   ///< of the gimbal rates from their angles [rad/s]
  } estimator;

  /// [mirror]: how much the twin that follows the rig reckons with; services/mirror/README.md.
  struct Mirror {
    double moment_walk = 0.05;     ///< of the unknown moment, of U times 1 rad [1/sqrt(s)]
    double friction_walk = 0.002;  ///< of the disc's friction, of the drive's limit [1/sqrt(s)]
    double model_noise = 3e-4;     ///< of all accelerations, of U/A times 1 rad [1/sqrt(Hz)]
    double inertia_spread = 0.2;   ///< sigma of the structure's inertia [1]
    double drive_spread = 0.2;     ///< sigma of a drive's strength [1]
  } mirror;

  /// [hardware]: the line to the device of a real rig.
  struct Hardware {
    std::string device;  ///< terminal, e.g. /dev/serial/by-id/...; empty: none is named
    int baud = 0;        ///< of a UART; 0: the line has no rate of its own (USB CDC, pty)
  } hardware;

  /// [controller]: which law, and the numbers of any law; a law says which it misses.
  struct Controller {
    LawKind law = LawKind::kNone;
    std::optional<double> disc_speed;       ///< Om0, sought speed is -Om0 [rad/s]
    std::optional<double> kp;               ///< [N m s/rad]
    std::optional<double> ki;               ///< [N m/rad]
    std::optional<double> integral_limit;   ///< [N m]
    std::optional<double> momentum_rate;    ///< kappa [1/s]
    std::optional<double> elevation_gain;   ///< kd [N m/rad]
    std::vector<double> gain;               ///< overrides the Riccati solution when not empty
    std::optional<double> tilt_max;         ///< LQR weight 1/tilt_max^2 [rad]
    std::optional<double> speed_max;        ///< reduced LQR: disc speed error [rad/s]
    std::optional<double> gimbal_max;       ///< precession LQR [rad]
    std::optional<double> torque_max;       ///< [N m]
    Wave wave = Wave::kSine;                ///< open loop
    std::optional<double> amplitude;        ///< open loop [N m]
    std::optional<double> frequency;        ///< open loop [Hz]
    std::optional<double> phase;            ///< open loop, at the start [rad]
    std::optional<double> tilt_speed_gain;  ///< tilt to speed: disc speed per tilt [1/s]
    std::optional<double> rate_speed_gain;  ///< tilt to speed: disc speed per tilt rate [1]
    std::optional<double> speed_limit;      ///< tilt to speed [rad/s]
    std::optional<double> tilt_gain;        ///< precession: kth [N m/rad]
    std::optional<double> gimbal_gain;      ///< precession, shelf: kap, accelerating [N m/rad]
    std::optional<double> gimbal_damping;   ///< precession, shelf: cq of the law [N m s/rad]
    std::optional<double> shelf_torque;     ///< shelf: Ts [N m]
    std::optional<double> shelf_tilt;       ///< shelf: th_s [rad]
  } controller;

  std::vector<double> initial_q;  ///< [rad], as many as coordinates
  std::vector<double> initial_v;  ///< [rad/s]
  double initial_rotor_share =
      1.0;  ///< rotor speeds then, of the nominal; rotor_drive.start_share [1]

  double reference_impulse_nms = 0.0;  ///< the push that shows the rig well, about x (roll)
  double impulse_duration_s = 0.02;    ///< of pushes that name none

  model::Machine build_machine() const;
  /// The state that HELD holds: [initial].
  model::State initial_state(const model::Machine& built) const;
};

/// Reads a rig.
/// @param name_or_path a path (it has a '/' or ends in .toml) or the bare name of a shipped rig
/// @param overrides `key=value` texts as in `--set`, e.g. `controller.gain=[1, 2, 3]`; later wins
/// @throws Error listing all mistakes, each on a line `file:line:col: error: ...` with the fix
Rig load_rig(const std::string& name_or_path, const std::vector<std::string>& overrides = {});

/// The rig file with the overrides applied, as TOML.
std::string print_rig(const std::string& name_or_path, const std::vector<std::string>& overrides);

/// Folder of the shipped rigs: $GYROTWIN_RIGS, or found from the program's own place.
/// @throws Error when there is none.
std::filesystem::path rig_folder();

/// Bare names of the shipped rigs, sorted.
std::vector<std::string> shipped_rigs();

/// The name in the file and on the command line.
std::string_view name_of(LawKind law);

}  // namespace gyrotwin
