// How to step, in words.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "services/integrator/stepper.hpp"

namespace gyrotwin {

inline constexpr std::array<std::pair<const char*, StepPolicy::Kind>, 3> kSteppers{
    {{"fixed", StepPolicy::Kind::kFixed},
     {"adaptive", StepPolicy::Kind::kAdaptive},
     {"quick", StepPolicy::Kind::kQuick}}};

/// Said once, for all who ask for one.
inline constexpr const char* kStepperHelp =
    "fixed: loop.substeps a tick, as a live system; adaptive: as fine as a relative error of 1e-12 "
    "asks; quick: as coarse as an error of 2e-7 a step allows";

inline std::vector<std::string> stepper_words() {
  std::vector<std::string> words;
  for (const auto& [word, kind] : kSteppers) words.emplace_back(word);
  return words;
}

/// @param word one of stepper_words()
inline StepPolicy::Kind stepper_of(const std::string& word) {
  return std::ranges::find(kSteppers, word, [](const auto& s) { return std::string(s.first); })
      ->second;
}

}  // namespace gyrotwin
