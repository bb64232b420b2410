// A plant on its bench: propped up or let go, with its disturbances and its sensors.
#pragma once

#include <cstdint>

#include "messages/channels.hpp"
#include "services/integrator/plant.hpp"
#include "services/integrator/schedule.hpp"
#include "services/integrator/simulated_sensors.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class BenchPlant {
 public:
  /// Propped at the rig's initial state, rotors powered.
  /// @param rig outlives the plant
  /// @throws Error where the rig has no [sensors]
  explicit BenchPlant(const Rig& rig);

  /// One tick. Propped, nothing moves but a disc, at its initial speed, and rotors; propped anew,
  /// it is put back to its initial state first.
  /// @param drives mode and drives; nothing else acts
  void advance(bool propped, const model::Input& drives) noexcept;

  bool rotors_powered = true;

  Schedule& schedule() noexcept { return schedule_; }
  const model::Machine& machine() const noexcept { return machine_; }
  /// Ticks since the start: of the schedule, of noise, of the record.
  std::int64_t tick() const noexcept { return tick_; }
  const model::State& state() const noexcept { return plant_.state(); }
  /// That led here, and what it did.
  const model::Input& input() const noexcept { return input_; }
  const model::Truth& truth() const noexcept { return truth_; }
  /// What the sensors say of the present tick; no header.
  const sensors_t& sensors() const noexcept { return sensors_; }
  /// false: the solver has failed, and nothing moves any more.
  bool sound() const noexcept { return sound_; }

 private:
  void hold(const model::Input& input) noexcept;
  void look() noexcept;

  const Rig& rig_;
  model::Machine machine_;
  GroundedPlant plant_;
  Schedule schedule_;
  SimulatedSensors sensing_;
  model::Input input_;
  model::Truth truth_;
  sensors_t sensors_{};
  std::int64_t tick_ = 0;
  bool propped_ = true;
  bool sound_ = true;
};

}  // namespace gyrotwin
