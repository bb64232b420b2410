// Whether a rig's key is fit for use here, and whether the others have the same.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// One thing that was looked at.
struct Finding {
  bool good;
  std::string text;  ///< what was found; where it is not good, the fix too
};

/// Whether the rig signs, and what the key's file and folder are; no bus.
/// @throws Error when there is no place for keys
std::vector<Finding> examine_key(const Rig& rig);

/// What was heard on the rig's bus.
struct Heard {
  std::int64_t with_this_key = 0, otherwise = 0;  ///< messages
  double seconds = 0.0;                           ///< of listening
};

/// Listens on the rig's bus, whose key there must be.
/// @throws Error when the bus cannot be opened
Heard listen(const Rig& rig, double seconds);

/// Whether those who were heard use this key. That nobody was heard is good, and is told.
Finding judge(const Heard& heard);

}  // namespace gyrotwin
