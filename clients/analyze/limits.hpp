// How much a rig stands, found by bisection on its full model under its own law.
#pragma once

#include <string>
#include <vector>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// The strongest load of one kind that it stands.
struct Limit {
  std::string key;      ///< "impulse_roll"
  std::string meaning;  ///< "impulse about x (roll), over 0.02 s"
  std::string unit;
  double stands;        ///< the strongest that was seen to stand; 0: none
  double falls;         ///< the weakest above it that was seen to fall; infinite: none
  double largest_tilt;  ///< at the strongest that stands [rad]
  double duration;      ///< of each run, from the load on [s]
};

/// Impulse, constant moment and gust about x, and about y where the machine has a pitch. A load
/// that still grows the tilt at the run's end is not stood. Loads are tried in doubling steps from
/// the rig's reference push and then halved between, to 2 %.
/// @param begin when the load comes: the rig has come to rest by then [s]
/// @param duration of each run from then on [s]
/// @param threads that share the work
std::vector<Limit> limits_of(const Rig& rig, double begin, double duration, int threads);

}  // namespace gyrotwin
