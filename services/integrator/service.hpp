// The integrator on the bus and in time: claims the rig, ticks, publishes, answers.
#pragma once

#include "services/integrator/integrator.hpp"
#include "services/runtime/bus.hpp"
#include "services/runtime/clock.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"
#include "services/runtime/rig_bus.hpp"

namespace gyrotwin {

/// One owner's life on the bus. The same thread does everything; nothing allocates after claim().
class IntegratorService {
 public:
  /// All references outlive the service.
  IntegratorService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon);

  /// Listens for a second whether somebody else owns the rig.
  /// @throws NotDone naming the other owner
  void claim();

  /// Ticks until the daemon stops.
  void run() noexcept;

 private:
  bool paced() const noexcept;
  bool bridges_pause(std::int64_t now) const noexcept;
  bool must_tick(std::int64_t now) const noexcept;
  void tick(std::int64_t now) noexcept;
  void rest(std::int64_t now) noexcept;

  void listen(std::int64_t now) noexcept;
  void on_request(const request_t& request, std::int64_t now) noexcept;
  void on_other_owner(const Reception& reception, std::int64_t now) noexcept;
  void await_controller(std::int64_t now) noexcept;

  void publish(std::int64_t now) noexcept;
  void send_state(std::int64_t now) noexcept;
  void repeat_state(std::int64_t now) noexcept;
  void follow_pace(std::int64_t now) noexcept;
  void follow_mode(std::int64_t now) noexcept;
  void report(std::int64_t now) noexcept;
  void publish_status() noexcept;
  void log_history() noexcept;

  const Rig& rig_;
  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  Integrator integrator_;
  Pacer pacer_;

  Identity identity_;
  state_t state_{};  // of the present tick; a repeat is the same message
  truth_t truth_{};
  sensors_t sensors_{};
  Stamp stamp_;                         // of all three
  std::int64_t asked_at_ = 0;           // wall time when state_ was first sent
  std::int64_t sent_at_ = 0;            // and last sent
  Mode followed_mode_ = Mode::kHeld;    // what publish, pacer and STATUS have followed
  std::int64_t status_due_ = 0;         // wall time
  std::int64_t window_due_ = 0;         // wall time at which the statistics roll
  bool was_paced_ = false;              // at the last look
  bool was_bridging_ = false;           // at the last look
  std::int64_t obeyed_at_ = 0;          // wall time of the last accepted COMMAND, or of arming
  std::int64_t controller_heard_ = -1;  // wall time; -1: never
  std::int64_t other_owner_heard_ = -1;
  std::int64_t status_sequence_ = 0;
  std::int64_t reply_sequence_ = 0;
};

}  // namespace gyrotwin
