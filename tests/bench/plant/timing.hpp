// Several subjects timed in turns.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <vector>

namespace gyrotwin::bench {

/// Each subject's pass, `evaluations` of what is measured, in turns for so long [s]. What caches
/// and branches hold is left otherwise by whoever came before, so the second of two passes counts.
/// @return medians over the turns, of one evaluation [ns]
inline std::vector<double> medians_in_turns(const std::vector<std::function<void()>>& passes,
                                            std::size_t evaluations, double seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> times(passes.size());
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(seconds));
  do {
    for (std::size_t s = 0; s < passes.size(); ++s) {
      passes[s]();
      const Clock::time_point begin = Clock::now();
      passes[s]();
      const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
      times[s].push_back(taken.count() / static_cast<double>(evaluations));
    }
  } while (Clock::now() < end);
  std::vector<double> medians;
  for (std::vector<double>& each : times) {
    const auto middle = each.begin() + static_cast<std::ptrdiff_t>(each.size() / 2);
    std::nth_element(each.begin(), middle, each.end());
    medians.push_back(*middle);
  }
  return medians;
}

}  // namespace gyrotwin::bench
