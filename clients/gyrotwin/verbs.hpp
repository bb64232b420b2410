// The programs behind `gyrotwin VERB`.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace gyrotwin {

/// A program `gyrotwin-NAME`.
struct Program {
  std::string_view name;
  std::string_view summary;
};

inline constexpr std::array<Program, 5> kDaemons{{
    {"integrator", "owns a simulated platform: physics, modes, limits"},
    {"hardware", "owns a real one, over a serial line: the same channels, modes and limits"},
    {"controller", "keeps it up: hears STATE, answers with COMMAND"},
    {"mirror", "the twin: follows a live rig, says what disagrees and what happens next"},
    {"gateway", "shows a rig in a browser; speaks with Foxglove, PlotJuggler, Prometheus"},
}};

inline constexpr std::array<Program, 13> kClients{{
    {"ctl", "arm, disarm, pause, step, reset ...; status; wait until it balances"},
    {"disturb", "push it, break parts of it, play a scenario, see it recover"},
    {"top", "how the rig is, live: state, margins, rates, losses, who is alive"},
    {"log", "keep the record: record, info, cat, replay, recover"},
    {"rerun", "a record once more through mirror or controller: the same bytes, or where not"},
    {"analyze", "whether a rig stands, by how much, and why: text, JSON or a page with pictures"},
    {"experiment", "coast-down, swing, run-down: runs one on a rig and records it"},
    {"calibrate", "parameters of a rig, with their covariance, from its logs"},
    {"sweep", "many rigs, starts and disturbances at once: which ones stand"},
    {"simulate", "the same rig offline, faster than real time, into a CSV"},
    {"rig_emulator", "a rig for those who have none: a plant and its firmware, on a line"},
    {"netcheck", "whether the network between hosts is good enough for a rig, and what to fix"},
    {"key", "make or show the key that signs the rig's messages"},
}};

/// What `gyrotwin --help` says.
std::string front_page();

/// The man page of `gyrotwin`, and what completes its first word (services/runtime/manual.hpp).
std::string front_manual();
std::string front_words();

/// Why there is no such verb, and what was probably meant.
std::string unknown_verb(std::string_view verb);

}  // namespace gyrotwin
