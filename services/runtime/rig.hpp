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
#include "services/model/umbrella.hpp"

namespace gyrotwin {

enum class ClockMode : std::uint8_t { kRealtime, kLockstep, kFree };
enum class OverrunPolicy : std::uint8_t { kSkip, kStop };
enum class SafeStopDrive : std::uint8_t { kZeroTorque, kBrake, kHoldSpeed };
enum class LawKind : std::uint8_t {
  kNone,
  kConstantSpeed,
  kMomentumManager,
  kReducedLqr,
  kPrecessionLqr
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
    double patience_s = 0.1;  ///< realtime: simulated time may stand still that long for a command
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

  std::variant<model::UmbrellaParameters, model::GimballedParameters> machine;

  /// [controller]: which law, and the numbers of any law; a law says which it misses.
  struct Controller {
    LawKind law = LawKind::kNone;
    std::optional<double> disc_speed;      ///< Om0, sought speed is -Om0 [rad/s]
    std::optional<double> kp;              ///< [N m s/rad]
    std::optional<double> ki;              ///< [N m/rad]
    std::optional<double> integral_limit;  ///< [N m]
    std::optional<double> momentum_rate;   ///< kappa [1/s]
    std::optional<double> elevation_gain;  ///< kd [N m/rad]
    std::vector<double> gain;              ///< overrides the Riccati solution when not empty
    std::optional<double> tilt_max;        ///< LQR weight 1/tilt_max^2 [rad]
    std::optional<double> speed_max;       ///< reduced LQR: disc speed error [rad/s]
    std::optional<double> gimbal_max;      ///< precession LQR [rad]
    std::optional<double> torque_max;      ///< [N m]
  } controller;

  std::vector<double> initial_q;  ///< [rad], as many as coordinates
  std::vector<double> initial_v;  ///< [rad/s]

  double reference_impulse_nms = 0.0;  ///< the push that shows the rig well, about x (roll)
  double impulse_duration_s = 0.02;    ///< of pushes that name none

  model::Machine build_machine() const;
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
