// The mirror on the bus: woken by SENSORS, it says at once where the twin is.
#pragma once

#include "services/mirror/mirror.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/histogram.hpp"
#include "services/runtime/owner_watch.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

/// One thread does everything; nothing allocates in run().
class MirrorService {
 public:
  /// All references outlive the service.
  /// @throws Error as Mirror does
  MirrorService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon);

  /// Follows until the daemon stops.
  void run() noexcept;
  /// All that waits on the bus, then a portion of forecasting and STATUS, as far as they are due.
  void round() noexcept;

 private:
  void listen() noexcept;
  void on_sensors(const sensors_t& sensors) noexcept;
  void look_ahead() noexcept;
  void on_owner(const status_t& status) noexcept;
  void report(std::int64_t now) noexcept;
  void explain(status_t& status, std::int64_t now) noexcept;
  bool same_host() const noexcept;

  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  OwnerWatch owner_;
  std::int64_t epoch_;  // of its STATUS
  Mirror mirror_;

  Identity identity_;
  std::int64_t sensors_heard_ = -1;  // of the owner that is followed
  std::int64_t told_ = -1;           // wall time of the last TWIN/STATE
  std::int64_t status_due_ = 0;      // wall time
  std::int64_t window_due_ = 0;      // wall time at which the statistics roll
  std::int64_t status_sequence_ = 0;
  WindowedHistogram follow_;   // SENSORS received to TWIN/STATE sent
  WindowedHistogram step_;     // all work for one SENSORS
  WindowedHistogram age_;      // SENSORS sent to TWIN/STATE sent, on one host
  std::int64_t behind_;        // TWIN/STATE that is older is worth a word
  std::int64_t spent_ = 0;     // on the last SENSORS, forecasting aside
  std::int64_t left_out_ = 0;  // portions of forecasting
};

}  // namespace gyrotwin
