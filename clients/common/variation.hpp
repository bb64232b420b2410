// --law, --mount and --track: a rig other than its file says.
#pragma once

#include <string>

#include "services/runtime/cli.hpp"

namespace gyrotwin {

/// Empty: not given.
struct Variation {
  std::string law, mount, track;
};

/// Adds the three options, which take the words of the rig file. CommandLine::run() writes to
/// `variation`.
void add_variation(Command& app, Variation& variation);

/// As if the rig had them; its initial state is carried over to another mount.
/// @throws Error when the rig is wrong, or has no mount and track
void apply(const Variation& variation, RigOptions& rig_options);

}  // namespace gyrotwin
