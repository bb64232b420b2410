// When ticks begin in wall time: absolute deadlines, overruns counted, never a race to catch up.
#pragma once

#include <cstdint>

#include "services/runtime/histogram.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// Deadlines of a periodic loop. Pure arithmetic on times that are handed in.
class Pacer {
 public:
  /// @param period_ns tick period of the owner's time [ns]
  /// @param spin_ns how long before a deadline sleep shall end [ns]
  Pacer(std::int64_t period_ns, OverrunPolicy policy, std::int64_t spin_ns = 0);

  /// The next deadline is one wall period after `now_ns`. To be called at start, resume and reset.
  void anchor(std::int64_t now_ns) noexcept;
  /// Simulated over wall time, finite and > 0; re-anchors.
  void set_speed(double factor, std::int64_t now_ns) noexcept;
  double speed() const noexcept { return speed_; }

  /// Wall time at which the next tick shall begin [ns].
  std::int64_t deadline() const noexcept { return deadline_; }
  /// Until when to sleep: `spin_ns` before the deadline, at most half a wall period.
  std::int64_t wake() const noexcept;
  /// The tick has begun at `now_ns`: records how late, moves the deadline on by one wall period.
  /// More than one period late is an overrun: the periods gone by are given up and counted, so that
  /// the next deadline lies ahead. @return false on an overrun under OverrunPolicy::kStop.
  bool begin(std::int64_t now_ns) noexcept;
  /// Time has stood still on purpose until `now_ns`: the periods gone by are counted as skipped,
  /// and the next deadline is one wall period from now. No lateness, no overrun.
  void give_up_until(std::int64_t now_ns) noexcept;
  /// The tick's work has taken this long [ns].
  void worked(std::int64_t ns) noexcept { compute_.add(ns); }

  std::int64_t overruns() const noexcept { return overruns_; }
  std::int64_t skipped_ticks() const noexcept { return skipped_; }
  WindowedHistogram& lateness() noexcept { return lateness_; }
  WindowedHistogram& compute() noexcept { return compute_; }

 private:
  std::int64_t period_;       ///< of the owner's time [ns]
  std::int64_t wall_period_;  ///< period_ / speed_ [ns]
  OverrunPolicy policy_;
  std::int64_t spin_;  ///< [ns]
  double speed_ = 1.0;
  std::int64_t deadline_ = 0;
  std::int64_t overruns_ = 0;
  std::int64_t skipped_ = 0;
  WindowedHistogram lateness_, compute_;
};

}  // namespace gyrotwin
