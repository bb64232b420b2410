// Whether a machine can fall.
#pragma once

#include <algorithm>

#include "services/model/machine.hpp"

namespace gyrotwin {

/// Whether the structure can tilt; one on a stand cannot.
inline bool has_tilt(const model::Machine& machine) {
  return std::ranges::any_of(machine.layout.tilt, [](int place) { return place != model::kFixed; });
}

}  // namespace gyrotwin
