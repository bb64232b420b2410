// For which rates a line is good. Pure. The budget and its reasons: README.md beside this file.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clients/netcheck/figures.hpp"

namespace gyrotwin::netcheck {

/// Rates that a verdict may name [Hz]; the rig's own is another.
inline constexpr std::array kRates{10'000.0, 5'000.0, 2'000.0, 1'000.0, 500.0, 250.0, 100.0, 50.0};

/// From a tick's deadline to the answer's arrival it may take this share of a tick; the rest is for
/// the work of owner and law.
inline constexpr double kBudget = 0.75;

/// This share of the ticks may miss the budget, the unanswered ones included.
inline constexpr double kMayMiss = 1e-3;

/// Why a rate is not good: the first that holds.
enum class Limit : std::uint8_t {
  kNone,
  kLoss,   ///< more than kMayMiss of the ticks have no answer at all
  kSlow,   ///< more than kMayMiss have none within the budget
  kStale,  ///< the newest command was once as old as safety.command_timeout_ticks
};

/// How the line would do at one rate.
struct Fit {
  double rate_hz = 0.0;
  std::int64_t budget_ns = 0;
  double unanswered = 0.0;     ///< share of the ticks
  double missed = 0.0;         ///< share of the ticks without an answer within the budget
  std::int64_t age_ticks = 0;  ///< of the newest command at worst, when a tick begins; 0: never old
  Limit limit = Limit::kNone;
  bool good() const { return limit == Limit::kNone; }
};

/// Parts of the time from a tick to its answer.
enum class Part : std::uint8_t { kNone, kWakeHere, kNetwork, kWakeThere };

/// What a line is good for.
struct LineVerdict {
  Fit rig{};                 ///< at the rig's own rate
  std::vector<Fit> rates{};  ///< kRates and the rig's, the highest first
  double good_for_hz = 0.0;  ///< the highest that is good; 0: none
  /// Took most of the time of the ticks that had an answer, but not within the rig's budget, and of
  /// those that were slept through.
  Part slowest = Part::kNone;
  /// The lowest rate that is not good; none when all are.
  const Fit* limited() const;
};

/// How the newest command would have aged, whatever the rate.
struct Staleness {
  std::int64_t silence_ns = 0;  ///< beyond one period, the longest without a newer answer
  std::int64_t lost_run = 0;    ///< most pings in a row without an answer
};
Staleness staleness(const Measurement& measured);

/// @param rig_hz the rig's rate
/// @param timeout_ticks safety.command_timeout_ticks
LineVerdict line_verdict(const Measurement& measured, double rig_hz, int timeout_ticks);

}  // namespace gyrotwin::netcheck
