// Whether one sensor says what the model expects of it, over a window of time. README.md, "Health".
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "messages/channels.hpp"
#include "services/mirror/follower.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class SensorJudge {
 public:
  static constexpr double kWindow = 0.2;  ///< of the means [s]

  SensorJudge() = default;
  /// @param channels of the sensor; 0: the rig has none
  SensorJudge(const Imperfection& imperfection, int channels, double tick_s);

  void reset() noexcept;
  /// One tick. @param heard as the message says, @param value its channels
  /// @param biased a bias that the rig file does not allow was found
  void take(bool heard, const double* value, const Innovation& innovation, bool biased) noexcept;

  /// health_t.NONE ... LATE
  std::int32_t verdict() const noexcept { return verdict_; }
  double nis() const noexcept { return nis_; }
  double limit() const noexcept { return limit_; }
  double rms() const noexcept;
  int late_by() const noexcept { return late_by_; }  ///< LATE: so many ticks
  int channels() const noexcept { return channels_; }
  /// Standard deviation of a reading.
  double noise() const noexcept { return std::sqrt(variance_); }

 private:
  static constexpr int kLags = 128;

  std::int32_t seen(bool heard, const double* value, const Innovation& innovation,
                    bool biased) noexcept;
  void compare_with_past(const double* value, const Innovation& innovation) noexcept;
  int best_lag() const noexcept;

  int channels_ = 0;
  double share_ = 0.0;     // of a tick in the means
  double variance_ = 0.0;  // of noise and rounding
  int patience_ = 0;       // ticks that a verdict must hold to be given or taken back
  double limit_ = 0.0;

  double nis_ = 1.0, square_ = 0.0;
  int silent_ = 0, insane_ = 0, stuck_ = 0, good_ = 0;  // ticks on end, as far as they matter
  std::array<std::array<double, Innovation::kMaxChannels>, kLags> past_{};  // expected
  std::array<double, kLags> lag_misfit_{};
  std::int64_t ticks_ = 0;
  int late_by_ = 0;
  std::int32_t verdict_ = 0;
};

}  // namespace gyrotwin
