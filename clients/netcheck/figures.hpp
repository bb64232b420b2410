// What was measured between two hosts, in numbers. Pure.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "services/runtime/probe.hpp"

namespace gyrotwin::netcheck {

/// One ping and what became of it.
struct Trip {
  static constexpr std::int64_t kNever = -1;

  std::int64_t tick = 0;          ///< its deadline is `tick` periods after the first one's
  std::int64_t lateness = 0;      ///< how long after its deadline it was sent [ns]
  std::int64_t network = kNever;  ///< on the way there and back, both kernels included [ns]
  std::int64_t turn = 0;    ///< from the other kernel's having it to its answer's being sent [ns]
  std::int64_t offset = 0;  ///< other's wall clock minus this one's, if both ways took as long [ns]

  bool answered() const { return network != kNever; }
  /// From the deadline to the answer in this host's kernel [ns]. @pre answered()
  std::int64_t response() const { return lateness + network + turn; }
};

/// From the four stamps of a round trip, which is answered from now on.
/// @param t1 sent here, t2 heard there, t3 sent there, t4 heard here; wall clocks of their hosts
/// [ns], from 0 to kProbeLatest
void complete(Trip& trip, std::int64_t t1, std::int64_t t2, std::int64_t t3, std::int64_t t4);

/// All that happened between this host and another one.
struct Measurement {
  std::int64_t period_ns = 0;      ///< of the pings
  std::int64_t ticks = 0;          ///< deadlines, the missed ones included
  std::vector<Trip> trips{};       ///< in the order of sending
  Heard heard{};                   ///< answers, at this end
  std::optional<Report> there{};   ///< the other end's account; absent when it has gone
  std::int64_t clock_step_ns = 0;  ///< by which this host's wall clock was set meanwhile
};

/// Nearest ranks of a distribution [ns]; all 0 when it is empty.
struct Spread {
  std::int64_t p50 = 0, p99 = 0, p999 = 0, max = 0;
};
Spread spread(std::vector<std::int64_t> values);

/// One way: what was sent, and what became of it.
struct Way {
  std::int64_t sent = 0, lost = 0, late = 0, repeats = 0, kernel_dropped = 0;
  std::int64_t ttl_sent = 0, ttl_min = -1, ttl_max = -1;
};

struct Figures {
  std::int64_t ticks = 0;
  std::int64_t missed = 0;       ///< deadlines at which this host slept
  std::int64_t unanswered = 0;   ///< of the pings sent
  std::optional<Way> out, back;  ///< absent when the other end gave no account
  Spread wake_here;              ///< from a deadline to its ping's being sent
  Spread wake_there;  ///< from the other kernel's having a ping to its answer's being sent
  Spread network;     ///< the rest of the round trip
  Spread jitter;      ///< of `network`: from one answered ping to the next
  Spread response;    ///< from a deadline to its answer; of those that were answered
  std::int64_t clock_offset = 0;       ///< other's wall clock minus this one's [ns]
  std::int64_t clock_uncertainty = 0;  ///< the offset is within +- this [ns]; 0 when unknown
};

/// @param ttl_here that this host sends with
Figures figures(const Measurement& measured, std::int64_t ttl_here);

}  // namespace gyrotwin::netcheck
