// The clock of a device: another zero than the host's, and another rate.
#pragma once

#include <cmath>
#include <cstdint>

#include "services/runtime/clock.hpp"

namespace gyrotwin {

/// Runs `drift_ppm` fast against `host`, and `offset_ns` ahead of it when it is made.
class DeviceClock final : public Clock {
 public:
  /// @param host outlives the clock
  /// @param drift_ppm above -1e6 [1e-6]
  DeviceClock(Clock& host, std::int64_t offset_ns, double drift_ppm)
      : host_(host), start_(host.now_ns()), offset_(offset_ns), drift_(1e-6 * drift_ppm) {}

  std::int64_t now_ns() const noexcept override {
    const std::int64_t gone = host_.now_ns() - start_;
    return start_ + offset_ + gone + std::llround(drift_ * static_cast<double>(gone));
  }

  void sleep_until(std::int64_t deadline_ns) noexcept override {
    host_.sleep_until(to_host(deadline_ns));
  }

  /// The host's time at a time of this clock, to a nanosecond or two.
  std::int64_t to_host(std::int64_t device_ns) const noexcept {
    const std::int64_t gone = device_ns - start_ - offset_;
    return start_ + gone - std::llround(drift_ / (1.0 + drift_) * static_cast<double>(gone));
  }

 private:
  Clock& host_;
  std::int64_t start_;  // by the host's clock
  std::int64_t offset_;
  double drift_;  // [1]
};

}  // namespace gyrotwin
