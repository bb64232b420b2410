// What may go wrong with a rig on its line, and when.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gyrotwin {

struct Trouble {
  enum class Kind : std::uint8_t {
    kSilent,   ///< nothing passes the line, either way
    kHalves,   ///< every frame ends somewhere in its middle, both ways
    kFlips,    ///< bits flip on the line, both ways
    kDeaf,     ///< the device does not read: what the host sends piles up
    kRestart,  ///< the firmware starts anew; the plant goes on
    kEstop,    ///< the button is pressed, then released
  };
  Kind kind;
  double at_s = 0.0;                      ///< since the rig's start [s]
  std::optional<double> duration_s = {};  ///< none: to the end; a restart has none [s]
  double share = 0.0;                     ///< kFlips: of the bytes that are hit
};

/// One kind, for --help.
struct TroubleWord {
  Trouble::Kind kind;
  std::string_view name, what;
};
std::span<const TroubleWord> trouble_words();

/// Reads `KIND[@AT][+DURATION][=SHARE]`, e.g. `silent@5+0.5`, `flips+2=0.001`; times in s.
/// @param now for one that names no time
/// @throws Error naming what was found and what is taken
Trouble parse_trouble(std::string_view text, double now);

}  // namespace gyrotwin
