// Whether a platform keeps itself up.
#pragma once

#include <cstdint>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Watches STATE until the tilt has stayed within a limit for long enough.
class BalanceWatch {
 public:
  /// @param limit largest tilt [rad]
  /// @param span_ns of the owner's time, without a break and in RUNNING
  BalanceWatch(double limit, std::int64_t span_ns) : limit_(limit), span_ns_(span_ns) {}

  /// @return whether it is balanced by now
  bool on(const state_t& state) noexcept;

  /// Tilt of the last state [rad]; negative before the first one.
  double tilt() const noexcept { return tilt_; }

 private:
  double limit_;
  std::int64_t span_ns_;
  double tilt_ = -1.0;
  bool within_ = false;
  std::int64_t epoch_ = 0, since_ns_ = 0;  // of the present stretch within the limit
};

}  // namespace gyrotwin
