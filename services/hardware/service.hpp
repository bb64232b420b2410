// The owner of a real plant on its line and on the bus: hears samples, publishes, answers.
#pragma once

#include "services/hardware/hardware.hpp"
#include "services/hardware/line.hpp"
#include "services/hardware/line_clock.hpp"
#include "services/runtime/owner_desk.hpp"

namespace gyrotwin {

/// One owner's life between line and bus. The same thread does everything; nothing allocates once
/// it runs.
class HardwareService {
 public:
  /// All references outlive the service.
  HardwareService(const Rig& rig, Line& line, Bus& bus, Clock& clock, Daemon& daemon);

  /// Until the daemon stops.
  void run() noexcept;

 private:
  void listen(std::int64_t now) noexcept;
  void hear_device(std::int64_t now) noexcept;
  void on_sample(const sensors_t& sample, std::int64_t now) noexcept;
  void keep_line(std::int64_t now) noexcept;
  void keep_time(std::int64_t now) noexcept;
  void send_beat(std::int64_t now) noexcept;
  void send_to_device(std::int64_t now) noexcept;

  void publish() noexcept;
  void follow_mode(std::int64_t now) noexcept;
  void report(std::int64_t now) noexcept;
  void publish_status(std::int64_t now) noexcept;
  void publish_link(std::int64_t now) noexcept;
  void rest(std::int64_t now) noexcept;

  const Rig& rig_;
  Line& line_;
  Bus& bus_;
  Clock& clock_;
  Daemon& daemon_;
  Hardware hardware_;
  OwnerDesk desk_;
  LineClock line_clock_;
  WindowedHistogram ages_;     // of samples when they arrive
  WindowedHistogram compute_;  // sample heard to STATE sent

  state_t state_{};
  sensors_t sensors_{};
  beat_t last_beat_{};  // of the device
  std::int64_t last_beat_at_ = 0;
  std::int64_t sample_at_ = -1;       // wall time of the newest sample; -1: none yet
  Mode followed_mode_ = Mode::kHeld;  // what STATUS has told
  std::int64_t followed_epoch_ = 0;   // likewise
  bool was_connected_ = false;        // at the last look
  bool said_closed_ = false;          // the line's last failure is in the log
  std::int64_t open_due_ = 0;         // wall time
  std::int64_t beat_due_ = 0, status_due_ = 0, window_due_ = 0;
  std::int64_t link_sequence_ = 0;
  std::int64_t beats_ = 0;
};

}  // namespace gyrotwin
