// Whether a simulated platform stands.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "services/model/machine.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

/// What is seen of a run, instant by instant; machines without a tilt are judged by their gimbals'
/// stops.
class Verdict {
 public:
  Verdict() = default;
  /// @param duration of the whole run [s]
  /// @param random a load of chance acts to the end, under which a late maximum tells nothing
  Verdict(const Rig& rig, const model::Machine& machine, double duration, bool random = false);

  /// The next instant [s] of this machine.
  void note(double t, const model::Machine& machine, const model::State& state) noexcept;

  bool has_tilt() const noexcept { return has_tilt_; }
  double tilt() const noexcept { return tilt_; }  ///< now [rad]
  double largest_tilt() const noexcept;           ///< until now; 0 without a tilt [rad]
  double least_margin() const noexcept;           ///< no tilt: to a stop [rad]
  /// When the tilt first passed safety.fall_tilt_rad, or a gimbal without a tilt its stop [s].
  std::optional<double> fell_at() const noexcept { return fell_at_; }
  /// It has toppled until its gimbals met their stops, and those hold it: tilted at the end, with a
  /// gimbal in its stop for most of the last tenth of the run (of 2 s, where that is less).
  bool leans() const noexcept;
  /// The last fifth of the run has seen clearly more than all before: nobody knows how it ends.
  bool growing() const noexcept;

  /// "leans on its gimbal stops at 23 deg".
  std::string leaning_text() const;
  /// "stands: tilt at most 2.91 deg, 0.05 deg at the end".
  std::string text() const;

 private:
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  bool has_tilt_ = true;
  bool stops_carry_ = false;  // tilt and gimbals are joined, by a ring or by momentum
  bool random_ = false;
  double limit_ = 0.0;  // of what is measured: the tilt, or minus the gimbals' margin [rad]
  double duration_ = 0.0;
  double t_ = 0.0, tilt_ = 0.0;
  double earlier_ = kNever, later_ = kNever;  // largest measure, by part of the run
  double late_ = 0.0, in_stop_ = 0.0;         // of the end: all, and in a stop [s]
  std::optional<double> fell_at_;
};

}  // namespace gyrotwin
