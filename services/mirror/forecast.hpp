// The next seconds of a rig, worked out in equal portions beside the ticks that are followed. Pure;
// README.md beside it says what is assumed, and how good it is.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "messages/channels.hpp"
#include "services/mirror/course.hpp"
#include "services/mirror/follower.hpp"

namespace gyrotwin {

/// What is assumed of what no sensor shows.
struct ForecastSettings {
  double lasting_s = 0.12;  ///< a moment that has acted for so long lasts [s]
  double fade_s = 0.02;     ///< what is beyond it fades with this time constant [s]
  /// An alarm: forecasts on end have seen it fall for so long [s], which sits a push out...
  double confirm_s = 0.08;
  double patience = 0.15;  ///< ...and for this share of the time that is left until the fall
};

class Forecast {
 public:
  static constexpr double kHorizon = 2.0;  ///< how far it looks [s]
  static constexpr double kRate = 50.0;    ///< forecasts a second of the owner's time
  static constexpr double kCourses = 1.2;  ///< full courses that are run for one forecast
  static constexpr int kDraws = 16;        ///< of starts, before they come again
  static constexpr int kShare = 8;         ///< last starts of which the share that falls is told

  /// @param machine the rig's; both outlive the forecast
  /// @throws Error as make_law()
  Forecast(const Rig& rig, const model::Machine& machine, const ForecastSettings& settings = {});

  /// Forgets: another run.
  void reset() noexcept;
  /// Remembers a tick, after Follower::step().
  /// @param at header of the SENSORS that the estimate is about
  /// @param stopped_from where the owner's safe stop began; null while it obeys the law
  void follow(const Estimate& estimate, const header_t& at,
              const model::State* stopped_from) noexcept;
  /// For a time in which nobody knows where the rig is: what was begun is thrown away, falls that
  /// were seen count no more, but an alarm that stands is not taken back.
  void break_off() noexcept;
  /// A portion, of which at most one follows each follow(). @return whether there is a new forecast
  bool work(const Follower& follower) noexcept;
  /// Everything but mac, as of the last new one; header.sequence counts them by the owner's time.
  void fill(forecast_t& forecast) const noexcept { forecast = forecast_; }

  double step_s() const noexcept { return step_; }   ///< of a course
  int portion() const noexcept { return portion_; }  ///< steps in a tick, at most

 private:
  void remember(const Estimate& estimate, bool lawful) noexcept;
  Outset outset(const Estimate& estimate) const noexcept;
  bool advance_start(const Follower& follower) noexcept;
  void begin_start(const Follower& follower) noexcept;
  void conclude(const Outcome& outcome) noexcept;
  double share(bool falls) const noexcept;
  void watch(const Outcome& outcome) noexcept;
  Eigen::Vector2d lasting_moment() const noexcept;

  const Rig& rig_;
  const model::Machine& machine_;
  ForecastSettings settings_;
  std::unique_ptr<Law> law_;
  double step_;
  std::int64_t period_;  // of forecasts [tick]
  int portion_;
  std::vector<double> normals_;  // kDraws times the state's, then kDraws times the moment's

  // Kept from tick to tick.
  header_t now_{};
  bool lawful_ = false;
  model::State stopped_from_;  // where the safe stop began, if not lawful
  LawState memory_ = LawState::Zero();
  static constexpr int kMoments = 16;                // over the time after which a moment lasts
  std::int64_t moment_period_;                       // from one of them to the next [tick]
  std::array<Eigen::Vector2d, kMoments> moments_{};  // a ring
  int moments_known_ = 0;                            // modulo its size once it is full

  // The forecast that is worked on.
  Course course_;
  bool busy_ = false;  // with it
  header_t at_{};
  std::int64_t falls_since_ns_ = -1;  // of those that see it fall, the first; -1: none
  bool alarmed_ = false;

  // The start that is worked on.
  Course start_course_;
  bool starting_ = false;             // with it
  int draw_ = 0;                      // of the next one
  std::array<bool, kShare> share_{};  // whether the last ones fall, a ring
  int shares_ = 0;                    // modulo its size once it is full

  forecast_t forecast_{};
};

}  // namespace gyrotwin
