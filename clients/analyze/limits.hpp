// How much a rig stands, found by bisection on its full model under its own law.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clients/analyze/cases.hpp"
#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// What becomes of a rig under a load, and how far it tilts.
struct Attempt {
  Fate fate;
  double largest_tilt;  ///< [rad]
};

/// Where standing ends.
struct Bracket {
  double stands = 0.0;        ///< the strongest that was seen to stand; 0: none
  double ends;                ///< the weakest above it that was not stood; infinite: none
  Fate how = Fate::kFalls;    ///< what became of it there
  double largest_tilt = 0.0;  ///< at the strongest that stands [rad]
};

/// Loads are tried in doubling steps, up or down from the first guess, 14 of them at most, and then
/// halved between, to 2 %.
/// @param first_guess > 0
Bracket bracket_of(const std::function<Attempt(double strength)>& attempt, double first_guess);

/// A tilt that still grows at a run's end is not stood from this share of the fall limit on; under
/// a load of chance, whose largest swing may well be the last, it counts for nothing.
inline constexpr double kGrowingFalls = 0.25;

/// The strongest load of one kind that it stands.
struct Limit {
  std::string key;      ///< "impulse_roll"
  std::string meaning;  ///< "impulse about x (roll), over 0.02 s"
  std::string unit;
  Bracket bracket;
  double duration;  ///< of each run, from the load on [s]
};

/// Impulse, constant moment and gust about x, and about y where the machine has a pitch, beginning
/// with the size of the rig's reference push. A load is stood when it ends neither in a fall nor
/// with the gimbals in their stops; a gust, when that is so for three seeds.
/// @param begin when the load comes [s]
/// @param duration of each run from then on [s]
/// @param threads that share the work
std::vector<Limit> limits_of(const Rig& rig, double begin, double duration, int threads);

}  // namespace gyrotwin
