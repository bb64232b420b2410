// The twin of a live rig, message by message: SENSORS and COMMAND in, TWIN/STATE, HEALTH and
// FORECAST out. Pure: it sees neither bus nor clock, so the same messages give the same bytes;
// services/mirror/service.hpp wires it to both.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "messages/channels.hpp"
#include "services/mirror/follower.hpp"
#include "services/mirror/forecast.hpp"
#include "services/mirror/health.hpp"
#include "services/onboard/safe_stop.hpp"
#include "services/runtime/command_gate.hpp"
#include "services/runtime/rig.hpp"

namespace gyrotwin {

class Mirror {
 public:
  static constexpr double kHealthRate = 100.0;  ///< HEALTH a second of the owner's time
  /// A follower that has lost the rig and begun anew in full motion knows enough for a forecast
  /// after so long [s], well before it has settled.
  static constexpr double kRipe = 0.2;
  /// Of sensors that contradict the twin, per channel over 0.2 s: normalised innovation squared,
  /// one sensor's at most 25. From there on it is not where the rig is, and nothing is forecast.
  static constexpr double kContradicted = 3.0;

  /// @param rig outlives the mirror
  /// @throws Error where the rig has no [sensors]
  explicit Mirror(const Rig& rig, const ForecastSettings& forecast = {});
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;

  /// Follows the owner that says this: a new epoch takes over here and nowhere else.
  void on_owner(const status_t& status) noexcept;
  /// The owner's mode at a tick.
  void on_state(const state_t& state) noexcept;
  void on_command(const command_t& command) noexcept;
  /// Readings of a tick, or the same again. @return whether TWIN/STATE is due
  bool on_sensors(const sensors_t& sensors) noexcept;
  /// HEALTH is due with the last SENSORS.
  bool health_due() const noexcept { return health_due_; }
  /// Time has gone by with the last SENSORS, and no portion of forecasting has been done for it.
  bool portion_due() const noexcept { return portion_due_; }
  /// The portion that is due. Who is behind leaves it out: forecasts come later then, but
  /// TWIN/STATE does not. @return whether FORECAST is due
  bool look_ahead() noexcept;

  /// Everything but mac and the sender's clock; headers are those of the SENSORS they belong to.
  void fill(state_t& state) const noexcept;
  /// Step times are the wiring's.
  void fill(health_t& health) const noexcept;
  void fill(forecast_t& forecast) const noexcept { forecast_.fill(forecast); }

  /// The owner's epoch that is followed; -1: no owner yet.
  std::int64_t owner_epoch() const noexcept { return epoch_; }
  std::int32_t mode() const noexcept { return mode_; }
  /// TWIN/STATE is worth hearing: it has watched the rig from its rest on, or for long enough.
  bool follows() const noexcept { return started_ && (from_rest_ || follower_.settled()); }
  const Estimate& estimate() const noexcept { return follower_.estimate(); }

 private:
  void offer_early(std::int64_t tick) noexcept;
  bool runs_over_last_tick() const noexcept;
  model::Input acted(std::int64_t tick) noexcept;
  void begin_run(std::int64_t epoch) noexcept;
  void watch_settling(std::int64_t tick) noexcept;
  void watch_misfit() noexcept;
  bool ripe() const noexcept;
  bool over() const noexcept;
  void keep_forecast_up() noexcept;

  const Rig& rig_;
  model::Machine machine_;
  CommandGate gate_;
  std::array<command_t, 2> early_{};  // for ticks whose SENSORS are still to come
  std::size_t early_count_ = 0;
  SafeStop safe_stop_;
  Follower follower_;
  Health health_;
  Forecast forecast_;
  std::int64_t health_period_;  // [tick]

  std::int64_t epoch_ = -1;
  std::int32_t mode_ = status_t::MODE_HELD;         // newest that is known
  std::int32_t mode_before_ = status_t::MODE_HELD;  // with the SENSORS before the last
  bool started_ = false;                            // the follower has had SENSORS of this run
  bool portion_due_ = false;                        // of forecasting, since the last SENSORS
  bool health_due_ = false;
  std::int64_t unsettled_since_ = 0;  // [tick]
  bool was_settled_ = false;
  double misfit_ = 1.0;                       // of the sensors, per channel
  bool from_rest_ = false;                    // followed since it was HELD
  sensors_t sensors_{};                       // the last ones
  model::Input acting_;                       // over the tick that ended with them
  std::optional<model::State> stopped_from_;  // where the safe stop began
};

}  // namespace gyrotwin
