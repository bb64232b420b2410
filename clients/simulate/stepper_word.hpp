// How to step, in words.
#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "services/integrator/stepper.hpp"

namespace gyrotwin {

/// In the order of StepPolicy::Kind.
inline constexpr std::array<std::string_view, 3> kStepperWords{"fixed", "adaptive", "quick"};

/// For --help, wherever one is asked for.
inline constexpr const char* kStepperHelp =
    "fixed: loop.substeps a tick, as a live system; adaptive: as fine as a relative error of 1e-12 "
    "asks; quick: Kutta's third order, as coarse as an error of 2e-7 (1 + |y|) a step allows";

inline std::string word_of(StepPolicy::Kind kind) {
  return std::string(kStepperWords[static_cast<std::size_t>(kind)]);
}

/// @throws std::invalid_argument for a word that is none of kStepperWords
inline StepPolicy::Kind stepper_of(std::string_view word) {
  const auto* found = std::ranges::find(kStepperWords, word);
  if (found == kStepperWords.end()) throw std::invalid_argument("no stepper has that name");
  return static_cast<StepPolicy::Kind>(found - kStepperWords.begin());
}

inline std::vector<std::string> stepper_words() {
  return {kStepperWords.begin(), kStepperWords.end()};
}

}  // namespace gyrotwin
