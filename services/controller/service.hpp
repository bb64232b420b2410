// The controller on the bus: woken by STATE, it answers at once.
#pragma once

#include "services/controller/controller.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/histogram.hpp"
#include "services/runtime/owner_watch.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

/// Whose STATE it answers: the owner's or the mirror's.
enum class Feedback : std::uint8_t { kLive, kTwin };

/// One thread does everything; nothing allocates in run().
class ControllerService {
 public:
  /// All references outlive the service.
  ControllerService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon,
                    Feedback on = Feedback::kLive);

  /// Answers until the daemon stops.
  void run() noexcept;

  const Law& law() const noexcept { return controller_.law(); }

 private:
  void hear(const Reception& reception, std::int64_t now) noexcept;
  void on_state(const state_t& state, std::int64_t now) noexcept;
  void on_owner(const status_t& status, std::int64_t now) noexcept;
  void report(std::int64_t now) noexcept;
  bool twin_lost(std::int64_t now) const noexcept;

  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  OwnerWatch owner_;
  std::int64_t epoch_;  // of what it sends; a new one for every run of the owner
  Controller controller_;
  Feedback on_;

  Identity identity_;
  std::int64_t state_heard_ = -1;  // wall time, of whom it is on; -1: never
  std::int64_t answered_at_ = -1;  // wall time of the last COMMAND
  std::int64_t status_due_ = 0;    // wall time
  std::int64_t window_due_ = 0;    // wall time at which the statistics roll
  std::int64_t status_sequence_ = 0;
  bool said_twin_lost_ = true;  // nothing to say before a twin was there
  WindowedHistogram compute_;   // STATE received to COMMAND sent
};

}  // namespace gyrotwin
