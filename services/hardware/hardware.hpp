// The owner of a real plant: what its device measures becomes STATE, what is commanded goes down
// the line. Pure: it sees neither line, bus nor clock; service.hpp wires it to them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "messages/channels.hpp"
#include "services/hardware/sample_rate.hpp"
#include "services/model/machine.hpp"
#include "services/onboard/estimator.hpp"
#include "services/runtime/owner.hpp"

namespace gyrotwin {

class Hardware final : public Owner {
 public:
  /// HELD, nothing heard of the device.
  /// @param rig outlives the owner
  /// @param epoch random, of the first run
  /// @throws Error where the rig has no [sensors] or its clock is not realtime
  Hardware(const Rig& rig, std::int64_t epoch);

  bool on_command(const command_t& command) noexcept override;

  /// Whether a device of this rig can have said what begins like that: of this rig, by somebody
  /// else than the owner, with stamps and counts that can be added and subtracted.
  bool plausible(const header_t& header) const noexcept;
  /// A sample of the device: the next tick where time goes on. Samples left out are ticks gone by.
  /// @return whether it is news
  bool on_sample(const sensors_t& sample) noexcept;
  void on_beat(const beat_t& beat) noexcept;
  /// The device's answer to a request that was forwarded. @return whether `reply` is due
  bool on_reply(const reply_t& answer, reply_t& reply) noexcept;
  /// @param now wall time [ns]
  /// @return whether `reply` is due: to a forwarded request that the device has not answered in
  /// time
  bool overdue(std::int64_t now, reply_t& reply) noexcept;
  /// The device is heard, or no longer.
  void set_connected(bool connected) noexcept { connected_ = connected; }
  /// How much faster than the host's clock the device's runs [1].
  void set_clock_drift(double drift) noexcept { clock_drift_ = drift; }

  /// The command that the device shall obey, once; within the drives' limits.
  std::optional<command_t> take_command() noexcept;
  /// A request for the device, once.
  std::optional<request_t> take_request() noexcept;
  /// What the device shall do; stamps and counters are the wiring's.
  void fill(beat_t& beat) const noexcept;

  /// Everything but header and mac.
  void fill(state_t& state) const noexcept;
  void fill(sensors_t& sensors) const noexcept;
  /// Everything but the wiring's: process, bus and loop.
  void fill(status_t& status) const noexcept;
  /// Only what is known here: the device, and what was missed.
  void fill(link_t& link) const noexcept;

 private:
  static constexpr std::size_t kPending = 8;
  using Text = std::uint8_t[sizeof status_t::text];
  struct Pending {
    request_t request;
    bool sent = false;
    bool outrun = false;   // by a reset
    std::int64_t due = 0;  // wall time by which it is answered; 0: to be set
  };

  void entering(Event event, Mode to) noexcept override;
  bool act(const request_t& request, const Surroundings& surroundings,
           reply_t& reply) noexcept override;
  bool arm(const request_t& request, const Surroundings& surroundings, reply_t& reply) noexcept;
  bool reset(const request_t& request, std::int64_t fresh_epoch, reply_t& reply) noexcept;
  bool set_rotors(const request_t& request, reply_t& reply) noexcept;
  bool forward(const request_t& request, reply_t& reply) noexcept;

  void new_device(std::int64_t epoch) noexcept;
  void estimate(std::int64_t ticks) noexcept;
  void judge() noexcept;
  bool pressed() const noexcept;
  /// What is wrong with the device in any mode. @return whether something is
  bool troubled(Text& why) const noexcept;
  /// What ARM would be refused for. @return whether it would
  bool hindered(Text& why) const noexcept;
  double limited(int drive, std::int32_t mode, double value) const noexcept;

  model::Machine machine_;
  OnboardEstimator estimator_;
  sensors_t sensors_{};   // the newest sample
  model::Input asked_{};  // of the device's drives
  std::optional<command_t> command_;
  std::array<std::optional<Pending>, kPending> pending_;
  std::optional<bool> rotors_asked_;  // in this run: power or none

  bool connected_ = false;
  std::optional<std::int32_t> device_mode_;  // as its last beat says
  std::int64_t device_epoch_ = -1;           // -1: none was heard
  std::optional<std::int64_t> device_tick_;  // of its newest sample
  SampleRate rate_;                          // by the device's clock
  double clock_drift_ = 0.0;                 // of the device's clock [1]
  bool has_estop_ = false;                   // in this run of the device
  std::int64_t missed_ = 0;                  // samples
  std::int64_t obeyed_ = 0;                  // commands, by the device
  std::int64_t device_stops_ = 0;            // safe stops that it entered by itself
  int beats_not_running_ = 0;                // while the owner runs
};

}  // namespace gyrotwin
