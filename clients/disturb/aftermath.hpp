// What a push did: the tilt that followed.
#pragma once

#include <cstdint>
#include <string>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Follows the tilt from the first tick of a push on, for some time of the owner.
class Aftermath {
 public:
  /// @param reply to the push: tells run and first tick
  /// @param tick_ns period of the owner's tick [ns]
  /// @param span_s how long to watch [s]
  Aftermath(const reply_t& reply, std::int64_t tick_ns, double span_s);

  /// Takes the next STATE. @return whether time went on: a later tick of the same run
  bool on(const state_t& state) noexcept;

  /// The span is over, or it fell.
  bool over() const noexcept { return fell() || time(tick_) >= span_s_; }
  /// FALLEN, or FAULT: nobody keeps it up any more.
  bool fell() const noexcept {
    return mode_ == status_t::MODE_FALLEN || mode_ == status_t::MODE_FAULT;
  }
  std::int64_t tick() const noexcept { return tick_; }

  /// "peak 2.912 deg after 0.08 s, 0.050 deg after 3 s", or "FALLEN after 0.8 s" and
  /// how to go on; says so when STATE tells no tilt.
  std::string text() const;

 private:
  /// Since the push began [s].
  double time(std::int64_t tick) const noexcept {
    return 1e-9 * static_cast<double>(tick_ns_) * static_cast<double>(tick - begin_);
  }

  std::int64_t epoch_, begin_, tick_ns_;
  double span_s_;
  std::int64_t tick_ = -1, peak_tick_ = 0;  // newest, and that of the peak
  double tilt_ = 0.0, peak_ = -1.0;         // [rad]; peak < 0: none was told
  std::int32_t mode_ = status_t::MODE_RUNNING;
};

}  // namespace gyrotwin
