// An angle followed through its measurements: a g-h filter (alpha-beta filter).
#pragma once

#include <cmath>

namespace gyrotwin {

/// What a filter knows of an angle.
struct Track {
  double angle = 0.0;  ///< [rad]
  double drift = 0.0;  ///< its rate, less what predict() is told of it [rad/s]
  int silent = 0;      ///< ticks since it was last measured
};

/// The gains; one filter serves many tracks.
class GhFilter {
 public:
  /// @param pole_1, pole_2 of the error's decay, equal for critical damping [rad/s]
  /// @param tick_s from one predict() to the next [s]
  GhFilter(double pole_1, double pole_2, double tick_s) : tick_s_(tick_s) {
    const double p1 = std::exp(-pole_1 * tick_s), p2 = std::exp(-pole_2 * tick_s);
    g_ = 1.0 - p1 * p2;
    h_ = (1.0 - p1) * (1.0 - p2);
  }

  /// One tick on. @param known part of the rate, from elsewhere [rad/s]
  void predict(Track& track, double known = 0.0) const noexcept {
    track.angle += tick_s_ * (known + track.drift);
  }
  void correct(Track& track, double measured) const noexcept {
    const double error = measured - track.angle;
    track.angle += g_ * error;
    track.drift += h_ / tick_s_ * error;
  }

 private:
  double tick_s_;
  double g_, h_;  // [1]
};

}  // namespace gyrotwin
