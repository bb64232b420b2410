// Ways to run a rig, simulated and linearised.
#pragma once

#include <optional>
#include <string>

#include "clients/analyze/modes.hpp"
#include "clients/simulate/trial.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// What becomes of one run.
enum class Fate {
  kStands,
  kGrows,  ///< not fallen, but its tilt still grows at the end
  kLeans,  ///< toppled onto its gimbals' stops, which hold it
  kFalls
};

/// @param growth of small deviations, where it is known; what is known to die out does not grow
Fate fate_of(const Trial& trial, std::optional<double> growth);

/// How a rig fares.
enum class Standing {
  kStands,    ///< comes back from small deviations and from its reference push
  kNeutral,   ///< neither comes back nor departs
  kDoubtful,  ///< stands, but departs slowly, or does not when it gets its reference push
  kLeans,     ///< toppled onto its gimbals' stops, which hold it
  kFalls      ///< from its initial state; without a tilt: a gimbal meets its stop
};

/// "stands", "neutral", "doubtful", "leans", "falls".
std::string word_for(Standing standing);

/// One way to run the rig, simulated and linearised.
struct Case {
  std::string key;   ///< "as_filed", "left_alone", "disc_free"
  std::string name;  ///< "under its law momentum_manager"
  Standing standing = Standing::kFalls;
  std::string sentence;  ///< "falls after 0.9 s"
  Trial undisturbed;     ///< from the initial state
  /// When loads come: once small deviations have died out, after 10 s at the latest; at once where
  /// it is not known that they do [s].
  double push_at = 0.0;
  std::optional<Trial> pushed;  ///< with the reference push; absent: there is none, or it fell
  std::optional<LinearModel> linear;
};

/// Growth of small deviations, where that is known for long [1/s].
std::optional<double> growth_of(const Case& seen);

/// Sets standing and sentence by all the rest.
void judge(const Rig& rig, Case& seen);

/// Runs the rig as it is, undisturbed for `duration` [s] or, where it departs slowly, longer, and
/// with its reference push, at push_at, for a third of that.
Case run_case(const Rig& rig, std::string key, std::string name, double duration);

/// The rig with its drives at rest.
Rig left_alone(Rig rig);

}  // namespace gyrotwin
