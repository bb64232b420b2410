// Several subjects timed in turns.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <vector>

namespace gyrotwin::bench {

/// What is timed at once: short beside the 4 ms after which a scheduler lets others run.
inline constexpr std::size_t kSlice = 32;

/// Evaluates one subject at samples [first, first + kSlice).
using Slice = std::function<void(std::size_t first)>;

/// Times subjects in turns, a slice of the samples each, for so long [s]. Whoever came before has
/// left caches and branches otherwise, so that the slice before the timed one is run untimed.
/// @param samples a multiple of kSlice
/// @return medians over the turns, of one evaluation [ns]
inline std::vector<double> medians_in_turns(const std::vector<Slice>& subjects, std::size_t samples,
                                            double seconds) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> times(subjects.size());
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(seconds));
  std::size_t before = 0;
  do {
    const std::size_t first = (before + kSlice) % samples;
    for (std::size_t s = 0; s < subjects.size(); ++s) {
      subjects[s](before);
      const Clock::time_point begin = Clock::now();
      subjects[s](first);
      const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
      times[s].push_back(taken.count() / static_cast<double>(kSlice));
    }
    before = first;
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
