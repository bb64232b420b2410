// Owner, controller and mirror in one process, message by message, without bus or clock.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/controller/controller.hpp"
#include "services/integrator/integrator.hpp"
#include "services/mirror/mirror.hpp"

namespace gyrotwin::support {

struct MirroredLoop {
  explicit MirroredLoop(Rig of, const ForecastSettings& forecast_settings = {})
      : rig(std::move(of)),
        integrator(rig, 1),
        controller(rig, 42),
        mirror(rig, forecast_settings) {}
  MirroredLoop(const std::string& name, const std::vector<std::string>& overrides)
      : MirroredLoop(load_rig(name, overrides)) {}

  reply_t ask(request_t request) {
    request.owner_epoch = integrator.epoch();
    request.writer = 9;
    request.counter = ++counter;
    reply_t reply;
    integrator.on_request(request, surroundings, reply);
    return reply;
  }
  reply_t ask(std::int32_t verb) {
    request_t request{};
    request.verb = verb;
    return ask(request);
  }
  reply_t reset() {
    ++surroundings.fresh_epoch;
    return ask(request_t::RESET);
  }

  /// SENSORS, STATE and STATUS to those who hear them, COMMAND back, one tick.
  void tick() {
    hear();
    integrator.advance();
  }
  void run_seconds(double seconds) {
    for (auto n = std::llround(seconds * rig.loop.rate_hz); n > 0; --n) tick();
  }

  void hear() {
    const header_t header{rig.id,
                          header_t::SIMULATION,
                          integrator.epoch(),
                          integrator.sequence(),
                          integrator.tick(),
                          integrator.sim_time_ns(),
                          0};
    status_t status{};
    integrator.fill(status);
    status.header = header;
    if (status.mode != told_mode || header.epoch != told_epoch) {
      mirror.on_owner(status);
      controller.on_owner(status);
      told_mode = status.mode;
      told_epoch = header.epoch;
    }
    integrator.fill(state);
    state.header = header;
    integrator.fill(sensors);
    sensors.header = header;
    mirror.on_state(state);
    twin_told = mirror.on_sensors(sensors);
    if (twin_told) mirror.fill(twin);
    if (mirror.health_due()) mirror.fill(health);
    forecast_told = mirror.look_ahead();
    if (forecast_told) mirror.fill(forecast);

    commanded = controller_alive && (!on_twin || twin_told) &&
                controller.answer(on_twin ? twin : state, command);
    if (!commanded) return;
    integrator.on_command(command);
    if (command_heard) mirror.on_command(command);
  }

  double tilt() const { return integrator.plant().machine().tilt(integrator.plant().state()); }

  Rig rig;
  Integrator integrator;
  Controller controller;
  Mirror mirror;
  Surroundings surroundings{.controller_heard = true, .other_owner_heard = false, .fresh_epoch = 2};
  bool controller_alive = true, on_twin = false;
  bool command_heard = true;  // by the mirror
  std::int64_t counter = 0;
  std::int64_t told_epoch = -1;
  std::int32_t told_mode = -1;

  // Of the last tick.
  state_t state{}, twin{};
  sensors_t sensors{};
  command_t command{};
  health_t health{};
  forecast_t forecast{};
  bool twin_told = false, forecast_told = false, commanded = false;
};

}  // namespace gyrotwin::support
