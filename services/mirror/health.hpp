// Does the rig do what its model does, and if not, who is to blame? README.md beside it says how.
#pragma once

#include <array>
#include <cstdint>

#include "messages/channels.hpp"
#include "services/mirror/follower.hpp"
#include "services/mirror/rotor_watch.hpp"
#include "services/mirror/sensor_judge.hpp"

namespace gyrotwin {

class Health {
 public:
  /// @param machine the rig's; must outlive it
  /// @throws Error where the rig has no [sensors]
  Health(const Rig& rig, const model::Machine& machine);
  void reset() noexcept;
  /// After each Follower::step(), with what that was given.
  void take(const Follower& follower, const sensors_t& sensors,
            const model::Input& acting) noexcept;
  /// Everything but header, step times and mac.
  void fill(health_t& health) const noexcept { health = health_; }
  /// Sensors that the follower must not use: sum of VALID_*. Those that are late; the gyro where
  /// several begin to disagree, to see whether the others agree without it.
  std::int32_t distrusted() const noexcept;

 private:
  /// Something of the model that is not as the rig has it: said when it is sure; taken back when it
  /// is sure of the contrary, or has been in doubt for long.
  struct Part {
    bool off = false;
    int sure = 0, good = 0, unsure = 0;  // ticks on end, as far as they matter
    /// @param value departure @param sigma of it @param matters from where on it does
    void take(double value, double sigma, double matters, int patience, int doubt,
              int settling = 1) noexcept;
  };

  void judge_sensors(const Follower& follower, const sensors_t& sensors) noexcept;
  void judge_parts(const Follower& follower) noexcept;
  void blame(const Follower& follower) noexcept;
  bool blame_evident_sensor(const Follower& follower) noexcept;
  bool blame_part(const Follower& follower) noexcept;
  bool blame_disagreeing_sensors(const Follower& follower) noexcept;
  void say_sensor(int sensor, const Follower& follower) noexcept;

  const model::Machine& machine_;
  int patience_;         // ticks for which a verdict must be over to be taken back
  int doubt_;            // or unsure
  int settling_;         // for which a part must be off to be named
  int naming_;           // for which sensors must disagree to be named
  int trial_length_;     // for which the gyro is left out
  double toppling_;      // U [N m/rad]
  double supply_ = 0.0;  // nominal [V]
  std::array<SensorJudge, kHealthSensors> sensor_;
  std::array<bool, kHealthSensors> biased_{};
  RotorWatch rotors_;
  int blamed_rotor_ = -1;
  static constexpr int kUnknown = -1;
  int losses_ = kUnknown;  // of the follower, which counts over all runs, when it was last settled
  int disagreeing_ = 0;    // ticks on end in which some sensor has disagreed
  int trial_ = 0;          // ticks on end in which several have
  std::array<Part, 2> moment_;
  Part friction_, inertia_;
  std::array<Part, model::kMaxDrives> drive_;
  health_t health_{};
};

}  // namespace gyrotwin
