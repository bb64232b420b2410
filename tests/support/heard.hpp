// A rig as one listener hears it, message by message. Link gyrotwin_top_core.
#pragma once

#include <array>
#include <cstdint>

#include "clients/top/monitor.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/text.hpp"

namespace gyrotwin {

inline constexpr std::int64_t kTenth = 100'000'000;  // [ns]

/// A monitor with a clock, messages without a bus, and the counters that the bus would have.
class Listening {
 public:
  template <class Message>
  void hear(Channel channel, const Message& message) {
    std::array<std::uint8_t, kWireSize<Message>> payload{};
    message.encode(payload.data(), 0, static_cast<int>(payload.size()));
    ++bus.received[static_cast<std::size_t>(channel)];
    monitor.hear({channel, false, payload}, now());
  }

  /// Looks ten times a second for so long.
  void pass(std::int64_t ns) {
    for (std::int64_t passed = 0; passed < ns; passed += kTenth) {
      clock.advance(kTenth);
      monitor.look(now(), bus);
    }
  }

  Moment now() const { return {clock.now_ns(), kStart + clock.now_ns()}; }
  Picture picture() const { return monitor.picture(now()); }

  static constexpr std::int64_t kStart = 1'769'894'043'120'000'000;  // 2026-01-31T21:14:03.120Z
  FakeClock clock;
  BusCounters bus;
  Monitor monitor;
};

inline status_t owner_status(std::int32_t mode = status_t::MODE_RUNNING, const char* why = "") {
  status_t status{};
  status.header.epoch = 0x1122334455667788;
  status.header.tick = 5000;
  status.header.sim_time_ns = 5'000'000'000;
  status.service = status_t::INTEGRATOR;
  status.mode = mode;
  status.clock = status_t::PACE_REALTIME;
  status.pid = 4711;
  set_text(status.host, "lab");
  set_text(status.text, "{}", why);
  status.speed_factor = 1.0;
  status.tick_period_ns = 1'000'000;
  return status;
}

inline status_t controller_status() {
  status_t status{};
  status.header.epoch = 12;
  status.service = status_t::CONTROLLER;
  status.mode = status_t::MODE_ACTIVE;
  status.pid = 4712;
  set_text(status.host, "lab");
  return status;
}

}  // namespace gyrotwin
