// The integrator on the bus and in time: ticks, publishes, answers.
#pragma once

#include "services/integrator/integrator.hpp"
#include "services/runtime/owner_desk.hpp"
#include "services/runtime/pacer.hpp"

namespace gyrotwin {

/// One owner's life on the bus. The same thread does everything; nothing allocates once it runs.
class IntegratorService {
 public:
  /// All references outlive the service.
  IntegratorService(const Rig& rig, Bus& bus, Clock& clock, Daemon& daemon);

  /// Ticks until the daemon stops.
  void run() noexcept;

 private:
  bool paced() const noexcept;
  bool bridges_pause(std::int64_t now) const noexcept;
  bool must_tick(std::int64_t now) const noexcept;
  void tick(std::int64_t now) noexcept;
  void rest(std::int64_t now) noexcept;

  void listen(std::int64_t now) noexcept;
  void await_controller(std::int64_t now) noexcept;

  void publish(std::int64_t now) noexcept;
  void send_state(std::int64_t now) noexcept;
  void repeat_state(std::int64_t now) noexcept;
  void follow_pace(std::int64_t now) noexcept;
  void follow_mode(std::int64_t now) noexcept;
  void report(std::int64_t now) noexcept;
  void publish_status(std::int64_t now) noexcept;
  void log_history() noexcept;

  const Rig& rig_;
  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  Integrator integrator_;
  OwnerDesk desk_;
  Pacer pacer_;

  state_t state_{};  // of the present tick; a repeat is the same message
  truth_t truth_{};
  sensors_t sensors_{};
  Stamp stamp_;                       // of all three
  std::int64_t asked_at_ = 0;         // wall time when state_ was first sent
  std::int64_t sent_at_ = 0;          // and last sent
  Mode followed_mode_ = Mode::kHeld;  // what publish, pacer and STATUS have followed
  std::int64_t status_due_ = 0;       // wall time
  std::int64_t window_due_ = 0;       // wall time at which the statistics roll
  bool was_paced_ = false;            // at the last look
  bool was_bridging_ = false;         // at the last look
  std::int64_t obeyed_at_ = 0;        // wall time of the last accepted COMMAND, or of arming
};

}  // namespace gyrotwin
