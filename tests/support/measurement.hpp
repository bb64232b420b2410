// A measurement of netcheck's, made by hand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "clients/netcheck/figures.hpp"

namespace gyrotwin::netcheck {

inline constexpr std::int64_t kMs = 1'000'000;  // [ns]
inline constexpr std::int64_t kUs = 1'000;      // [ns]

/// A second at 1 kHz whose answers all come 300 us after the tick: 100 us late, 150 on the network,
/// 50 at the other end.
inline Measurement steady(std::int64_t ticks = 1000) {
  Measurement m{.period_ns = kMs, .ticks = ticks};
  for (std::int64_t k = 0; k < ticks; ++k) {
    m.trips.push_back({.tick = k, .lateness = 100 * kUs, .network = 150 * kUs, .turn = 50 * kUs});
  }
  m.heard.distinct = ticks;
  m.there = Report{.answered = ticks, .heard = {.distinct = ticks}};
  return m;
}

inline void lose(Measurement& m, std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) m.trips[i].network = Trip::kNever;
}

}  // namespace gyrotwin::netcheck
