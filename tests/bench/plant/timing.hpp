// Several subjects timed in turns.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace gyrotwin::bench {

/// Evaluates one subject `count` times: at sample `first` and those after it, round and round.
using Slice = std::function<void(std::size_t first, std::size_t count)>;

/// Times subjects in turns, equally long: short beside the 4 ms after which a scheduler lets others
/// run, long beside what a subject takes to find its code and its branches again after the others.
/// @param samples how many there are
/// @return medians over the turns, of one evaluation [ns]
inline std::vector<double> medians_in_turns(const std::vector<Slice>& subjects, std::size_t samples,
                                            double seconds) {
  using Clock = std::chrono::steady_clock;
  constexpr double kTurn = 100e3;       // [ns]
  constexpr std::size_t kUntimed = 32;  // evaluations at the begin of a turn
  const auto time = [](const Slice& subject, std::size_t first, std::size_t count) {
    const Clock::time_point begin = Clock::now();
    subject(first, count);
    const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
    return taken.count() / static_cast<double>(count);
  };
  std::vector<std::size_t> count;
  for (const Slice& subject : subjects) {
    time(subject, 0, samples);
    count.push_back(static_cast<std::size_t>(std::ceil(kTurn / time(subject, 0, samples))));
  }

  std::vector<std::vector<double>> times(subjects.size());
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(seconds));
  std::size_t first = 0;
  do {
    for (std::size_t s = 0; s < subjects.size(); ++s) {
      subjects[s](first, kUntimed);
      times[s].push_back(time(subjects[s], (first + kUntimed) % samples, count[s]));
    }
    first = (first + kUntimed) % samples;
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
