// Pushes as people mean them, and the requests that do them.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Force at the structure's centre of mass and moment on the structure, world frame (x forward: a
/// moment about it rolls; y left: pitches; z up: yaws); or their impulses, where a function says
/// so.
struct Push {
  std::array<double, 3> moment{};  ///< [N m], impulse: [N m s]
  std::array<double, 3> force{};   ///< [N], impulse: [N s]

  bool nothing() const { return *this == Push{}; }
  bool operator==(const Push&) const = default;
};

/// When a push acts.
struct Timing {
  double duration_s = 0.0;  ///< rounded to ticks, at least one; 0: a load that stays until clear
  std::int64_t start_tick = 0;  ///< 0: the next one
};

/// Gives the impulse exactly: it is spread over the duration as the owner rounds it.
/// @param tick_ns period of the owner's tick [ns], > 0
/// @pre 0 < timing.duration_s
request_t impulse_request(const Push& impulse, const Timing& timing, std::int64_t tick_ns);

/// Constant force and moment.
request_t load_request(const Push& load, const Timing& timing, std::int64_t tick_ns);

/// "1 N m s about roll and 2 N s along x".
/// @param unit_of_time " s" for an impulse, "" for a load
std::string describe(const Push& push, std::string_view unit_of_time);

}  // namespace gyrotwin
