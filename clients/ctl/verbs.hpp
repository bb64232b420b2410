// Requests that ctl makes, and how their answers read.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "messages/channels.hpp"

namespace gyrotwin {

/// One verb that an owner answers.
struct Verb {
  std::string_view name;     ///< on the command line
  std::int32_t verb;         ///< request_t
  std::string_view summary;  ///< for --help
  std::string_view done;     ///< stands before the owner's own words; empty: they say it all
};

inline constexpr std::array<Verb, 9> kVerbs{{
    {"arm", request_t::ARM, "Let the held plant go: the controller's commands act", "armed"},
    {"disarm", request_t::DISARM, "Stop safely; reset leads back to HELD", "disarmed"},
    {"pause", request_t::PAUSE, "Let a simulated plant's time stand still", "paused"},
    {"resume", request_t::RESUME, "Let time go on", "resumed"},
    {"step", request_t::STEP, "Run that many ticks of a paused plant", "stepping"},
    {"reset", request_t::RESET, "Back to HELD at the initial state, from any mode", "reset"},
    {"speed", request_t::SPEED, "Simulated over wall time, e.g. 0.5 is half as fast", ""},
    {"rotors", request_t::ROTORS, "Let all flywheels spin up, or coast down", ""},
    {"clear", request_t::CLEAR, "End all disturbances and faults, also those to come", ""},
}};

/// "armed: RUNNING from tick 0".
/// @param reply APPLIED
std::string applied_line(const Verb& verb, const reply_t& reply);

}  // namespace gyrotwin
