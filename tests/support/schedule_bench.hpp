// A schedule by itself, on a rig that has all that disturbances and faults can ask for.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/integrator/schedule.hpp"
#include "services/runtime/text.hpp"
#include "tests/support/allocation_counter.hpp"

namespace gyrotwin::support {

/// Tables that few rigs have; any umbrella or gimballed rig takes them.
inline std::vector<std::string> with_everything(std::vector<std::string> more = {}) {
  std::vector<std::string> overrides{"wind.area_m2=0.3",
                                     "wind.drag_coefficient=1.2",
                                     "wind.pressure_height_m=0.8",
                                     "rotor_drive.power_limit_w=200.0",
                                     "rotor_drive.torque_limit_nm=0.5",
                                     "rotor_drive.time_constant_s=0.5",
                                     "rotor_drive.viscous_drag_nms_per_rad=2e-5",
                                     "rotor_drive.coulomb_drag_nm=0.01",
                                     "rotor_drive.start_share=1.0"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

inline request_t disturbance(std::int32_t kind) {
  request_t request{};
  request.verb = request_t::DISTURB;
  request.kind = kind;
  return request;
}

inline request_t fault(std::int32_t kind, std::int32_t target = 0) {
  request_t request{};
  request.verb = request_t::FAULT;
  request.kind = kind;
  request.target = target;
  return request;
}

struct ScheduleBench {
  explicit ScheduleBench(const std::string& name = "prototype_b")
      : ScheduleBench(load_rig(name, with_everything())) {}
  explicit ScheduleBench(Rig made)
      : rig(std::move(made)), machine(rig.build_machine()), schedule(rig, machine) {}

  /// @return the number it got; 0: refused
  std::int64_t add(const request_t& request, std::int64_t tick = 0) {
    reply = {};
    const bool taken = schedule.add(request, tick, reply);
    return taken && reply.result == reply_t::APPLIED ? reply.id : 0;
  }

  model::Input apply(std::int64_t tick) {
    model::Input input;
    schedule.apply(tick, input);
    return input;
  }

  /// What gets through of readings that tell the tick: the channels of gyro, gimbals and rotors
  /// are 1000 tick + 10 i + 1, 2 and 3.
  sensors_t read(std::int64_t tick) {
    sensors_t sensors{};
    sensors.valid = +sensors_t::VALID_GYRO | +sensors_t::VALID_GIMBALS | +sensors_t::VALID_ROTORS |
                    +sensors_t::VALID_ESTOP;
    sensors.estop = static_cast<std::int32_t>(tick);
    for (int i = 0; i < 4; ++i) {
      const double base = 1000.0 * static_cast<double>(tick) + 10.0 * i;
      if (i < 3) sensors.gyro_rad_s[i] = base + 1.0;
      sensors.gimbal_angle_rad[i] = base + 2.0;
      sensors.rotor_speed_rad_s[i] = base + 3.0;
    }
    schedule.corrupt(tick, sensors);
    return sensors;
  }

  Rig rig;
  model::Machine machine;
  Schedule schedule;
  reply_t reply{};
};

}  // namespace gyrotwin::support
