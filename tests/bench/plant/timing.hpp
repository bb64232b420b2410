// Several subjects timed in turns.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <vector>

namespace gyrotwin::bench {

/// Evaluates one subject at the samples [first, last).
using Turn = std::function<void(std::size_t first, std::size_t last)>;

/// Times subjects in turns: all samples each, after some that are not timed, in which a subject
/// finds its code and its branches again after the others. Turns are to be short beside the 4 ms
/// after which a scheduler lets others run.
/// @param samples how many there are
/// @return medians over the turns, of one evaluation [ns]
inline std::vector<double> medians_in_turns(const std::vector<Turn>& subjects, std::size_t samples,
                                            double seconds) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t kUntimed = 32;
  std::vector<std::vector<double>> times(subjects.size());
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(seconds));
  do {
    for (std::size_t s = 0; s < subjects.size(); ++s) {
      subjects[s](samples - kUntimed, samples);
      const Clock::time_point begin = Clock::now();
      subjects[s](0, samples);
      const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
      times[s].push_back(taken.count() / static_cast<double>(samples));
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
