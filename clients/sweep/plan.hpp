// Which runs a sweep has.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/sweep/variable.hpp"

namespace gyrotwin {

/// What one run sets: a text for each variable; factors not yet multiplied.
using Point = std::vector<std::string>;

/// Every combination of the lists, `repetitions` times each; the last list changes fastest, after
/// the repetitions. Pure: what a run sets hangs on the plan and the run's number alone.
struct Plan {
  std::vector<Variable> variables;
  std::int64_t repetitions = 1;
  std::uint64_t seed = 0;

  /// @throws Error when there are more than 10^9
  std::int64_t runs() const;
  /// @pre 0 <= run < runs()
  Point point(std::int64_t run) const;
};

}  // namespace gyrotwin
