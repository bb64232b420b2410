// The modes of a plant's owner, and every way from one to another.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Numbers as on the wire.
enum class Mode : std::uint8_t {
  kHeld = status_t::MODE_HELD,           ///< plant held, drives off; rotors run where asked to
  kRunning = status_t::MODE_RUNNING,     ///< physics runs, commands are obeyed
  kPaused = status_t::MODE_PAUSED,       ///< simulation only: time stands still
  kSafeStop = status_t::MODE_SAFE_STOP,  ///< physics runs, drives do what the rig file says
  kFallen =
      status_t::MODE_FALLEN,      ///< physics runs on beyond the tilt limit, drives as in SAFE_STOP
  kFault = status_t::MODE_FAULT,  ///< the state is not to be trusted: nothing runs
};

enum class Event : std::uint8_t {
  kArm,
  kDisarm,
  kPause,
  kResume,
  kStep,
  kStepsDone,
  kReset,  // asked for
  kCommandLost,
  kConflict,
  kNoController,
  kControllerBack,  // noticed on the bus
  kTiltLimit,
  kNotFinite,
  kOverrun,  // noticed in the plant and the loop
  kEstop,
  kDeviceLost,
  kDeviceStopped,  // noticed on the line to a real plant
};

struct Transition {
  Mode from;
  Event event;
  Mode to;
  std::string_view when;
};

inline constexpr std::array kTransitions{
    Transition{Mode::kHeld, Event::kArm, Mode::kRunning, "arm"},
    Transition{Mode::kHeld, Event::kReset, Mode::kHeld, "reset"},
    Transition{Mode::kRunning, Event::kPause, Mode::kPaused, "pause"},
    Transition{Mode::kRunning, Event::kStepsDone, Mode::kPaused, "the ticks of step are done"},
    Transition{Mode::kRunning, Event::kNoController, Mode::kPaused,
               "lockstep: no command for this tick within 2 s"},
    Transition{Mode::kRunning, Event::kDisarm, Mode::kSafeStop, "disarm"},
    Transition{Mode::kRunning, Event::kCommandLost, Mode::kSafeStop,
               "no valid command for safety.command_timeout_ticks"},
    Transition{Mode::kRunning, Event::kConflict, Mode::kSafeStop,
               "another owner speaks for the rig"},
    Transition{Mode::kRunning, Event::kOverrun, Mode::kSafeStop,
               "a tick overran and loop.overrun is stop"},
    Transition{Mode::kRunning, Event::kEstop, Mode::kSafeStop, "hardware: E-stop pressed"},
    Transition{Mode::kRunning, Event::kDeviceLost, Mode::kSafeStop,
               "hardware: no sensors for safety.command_timeout_ticks"},
    Transition{Mode::kRunning, Event::kDeviceStopped, Mode::kSafeStop,
               "hardware: the device has stopped or restarted by itself"},
    Transition{Mode::kRunning, Event::kTiltLimit, Mode::kFallen,
               "tilt beyond safety.fall_tilt_rad"},
    Transition{Mode::kRunning, Event::kNotFinite, Mode::kFault,
               "solver failed or state not finite"},
    Transition{Mode::kRunning, Event::kReset, Mode::kHeld, "reset"},
    Transition{Mode::kPaused, Event::kResume, Mode::kRunning, "resume"},
    Transition{Mode::kPaused, Event::kStep, Mode::kRunning, "step: that many ticks"},
    Transition{Mode::kPaused, Event::kControllerBack, Mode::kRunning,
               "lockstep: the command it waited for"},
    Transition{Mode::kPaused, Event::kDisarm, Mode::kSafeStop, "disarm"},
    Transition{Mode::kPaused, Event::kConflict, Mode::kSafeStop,
               "another owner speaks for the rig"},
    Transition{Mode::kPaused, Event::kReset, Mode::kHeld, "reset"},
    Transition{Mode::kSafeStop, Event::kTiltLimit, Mode::kFallen,
               "tilt beyond safety.fall_tilt_rad"},
    Transition{Mode::kSafeStop, Event::kNotFinite, Mode::kFault,
               "solver failed or state not finite"},
    Transition{Mode::kSafeStop, Event::kReset, Mode::kHeld, "reset"},
    Transition{Mode::kFallen, Event::kNotFinite, Mode::kFault, "solver failed or state not finite"},
    Transition{Mode::kFallen, Event::kReset, Mode::kHeld, "reset"},
    Transition{Mode::kFault, Event::kReset, Mode::kHeld, "reset"},
};

/// Where an event leads from a mode; empty: the event has no meaning there.
constexpr std::optional<Mode> next(Mode from, Event event) {
  for (const Transition& t : kTransitions) {
    if (t.from == from && t.event == event) return t.to;
  }
  return std::nullopt;
}

constexpr std::string_view name_of(Mode mode) {
  constexpr std::array<std::string_view, 6> kNames{"HELD",      "RUNNING", "PAUSED",
                                                   "SAFE_STOP", "FALLEN",  "FAULT"};
  return kNames[static_cast<std::size_t>(mode)];
}

/// Name of a status_t.MODE_*, owners' and listeners'.
constexpr std::string_view mode_name(std::int32_t mode) {
  if (mode == status_t::MODE_WAITING) return "WAITING";
  if (mode == status_t::MODE_ACTIVE) return "ACTIVE";
  if (mode < status_t::MODE_HELD || mode > status_t::MODE_FAULT) return "unknown";
  return name_of(static_cast<Mode>(mode));
}

/// Name of a request_t verb, as on the command line.
constexpr std::string_view verb_name(std::int32_t verb) {
  constexpr std::array<std::string_view, 12> kNames{"arm",   "disarm", "pause",  "resume",
                                                    "step",  "reset",  "speed",  "disturb",
                                                    "clear", "cancel", "rotors", "fault"};
  if (verb < request_t::ARM || verb > request_t::FAULT) return "unknown request";
  return kNames[static_cast<std::size_t>(verb - 1)];
}

/// Program of an owner's status_t.service: "integrator", "hardware"; empty: no owner's.
constexpr std::string_view owner_program(std::int32_t service) {
  if (service == status_t::INTEGRATOR) return "integrator";
  return service == status_t::HARDWARE ? "hardware" : "";
}

/// What SPEED takes, simulated over wall time.
inline constexpr double kSlowestSpeed = 0.01, kFastestSpeed = 100.0;

/// Whether the plant's time goes on.
constexpr bool ticks(Mode mode) {
  return mode == Mode::kRunning || mode == Mode::kSafeStop || mode == Mode::kFallen;
}

}  // namespace gyrotwin
