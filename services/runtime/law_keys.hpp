// Which law fits which machine, and which numbers of [controller] it needs: for whoever reads a rig
// and for whoever makes a law of it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/rig.hpp"
#include "services/runtime/toml_reader.hpp"

namespace gyrotwin {

/// A number of [controller].
struct LawNumber {
  const char* key;
  std::optional<double> Rig::Controller::*value;
  Range range;
};

/// All of them.
std::span<const LawNumber> law_numbers();

/// A number that a law cannot do without.
struct MissingNumber {
  std::string_view key;
  bool unless_gain;  ///< a weight: `controller.gain` would do instead
};

/// Numbers that the law needs and does not find.
std::vector<MissingNumber> missing_numbers(const Rig::Controller& controller);

/// Why the rig's law is not one for its machine, and which ones are; empty when it is.
std::string misfit(const Rig& rig);

}  // namespace gyrotwin
