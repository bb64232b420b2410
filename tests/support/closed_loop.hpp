// Integrator and controller in one process, message by message, without bus or clock.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "services/controller/controller.hpp"
#include "services/integrator/integrator.hpp"

namespace gyrotwin::support {

struct ClosedLoop {
  explicit ClosedLoop(const std::string& name, const std::vector<std::string>& overrides = {})
      : rig(load_rig(name, overrides)), integrator(rig, 1), controller(rig, 42) {}

  reply_t ask(std::int32_t verb, request_t request = {}) {
    request.verb = verb;
    request.owner_epoch = integrator.epoch();
    request.writer = 9;
    request.counter = ++counter;
    last_request = request;
    reply_t reply;
    integrator.on_request(request, surroundings, reply);
    return reply;
  }

  void arm() { ASSERT_EQ(ask(request_t::ARM).result, reply_t::APPLIED); }

  /// STATE to the controller, COMMAND back, one tick.
  void run_ticks(std::int64_t ticks) {
    for (std::int64_t i = 0; i < ticks; ++i) {
      if (controller_alive) {
        status_t status{};
        status.header.epoch = integrator.epoch();
        controller.on_owner(status);
        state_t state;
        integrator.fill(state);
        state.header = {rig.id,
                        header_t::SIMULATION,
                        integrator.epoch(),
                        integrator.sequence(),
                        integrator.tick(),
                        integrator.sim_time_ns(),
                        0};
        command_t command;
        if (controller.answer(state, command)) integrator.on_command(command);
      }
      integrator.advance();
      peak = std::max(peak, tilt_deg());
    }
  }

  /// @return largest tilt meanwhile [deg]
  double run_seconds(double seconds) {
    peak = 0.0;
    run_ticks(static_cast<std::int64_t>(seconds * rig.loop.rate_hz + 0.5));
    return peak;
  }

  double tilt_deg() const {
    const GroundedPlant& plant = integrator.plant();
    return plant.machine().tilt(plant.state()) * 180.0 / std::numbers::pi;
  }

  Rig rig;
  Integrator integrator;
  Controller controller;
  Surroundings surroundings{.controller_heard = true, .other_owner_heard = false, .fresh_epoch = 2};
  bool controller_alive = true;
  request_t last_request{};
  std::int64_t counter = 0;
  double peak = 0.0;
};

}  // namespace gyrotwin::support
