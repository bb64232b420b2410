// A rig behind its line: a simulated plant, and the firmware that a real one would have. Pure:
// driven by times and bytes; main.cpp has clock and terminal.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clients/rig_emulator/bench_plant.hpp"
#include "clients/rig_emulator/line_damage.hpp"
#include "clients/rig_emulator/trouble.hpp"
#include "services/hardware/firmware/gyrotwin_device.h"

namespace gyrotwin {

class Emulator {
 public:
  /// HELD, propped up.
  /// @param rig outlives the emulator
  /// @param epoch random, of the firmware's first run
  /// @param now_ns by the device's clock
  Emulator(const Rig& rig, std::int64_t epoch, std::int64_t now_ns);
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;

  /// Something that goes wrong, from the next sample at the earliest.
  void cause(const Trouble& trouble);

  /// Bytes from the host, at a time of the device's clock.
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept;
  /// A tick of the plant, and a sample of the firmware. A command acts over the tick in which it
  /// has come.
  void tick(std::int64_t now_ns) noexcept;

  /// Bytes for the line, and that it has taken so many of them.
  std::span<const std::uint8_t> outgoing() const noexcept { return outgoing_; }
  void sent(std::size_t count) noexcept;
  /// false: nothing shall be read from the line now.
  bool reads() const noexcept { return !deaf_; }

  const gyrotwin_device& device() const noexcept { return device_; }
  const BenchPlant& plant() const noexcept { return plant_; }
  /// The device's tick less the plant's: another one after a restart.
  std::int64_t device_lead() const noexcept { return device_.samples - 1 - plant_.tick(); }
  /// Of the last tick or byte, by the firmware's clock, which begins anew with a restart.
  std::int64_t device_ns() const noexcept { return now_ - zero_; }
  /// Since the start [s].
  double time_s() const noexcept;
  std::int64_t restarts() const noexcept { return restarts_; }

 private:
  static constexpr std::size_t kLineBuffer = 4096;  // bytes that a line's driver takes

  struct Span {
    Trouble trouble;
    std::int64_t begin, end;  // plant ticks: in [begin, end)
  };

  gyrotwin_board board() noexcept;
  void start(std::int64_t epoch) noexcept;
  void follow_troubles() noexcept;
  bool propped() const noexcept;
  std::size_t write(const std::uint8_t* bytes, std::size_t size) noexcept;
  void answer(const gyrotwin_request& request, gyrotwin_reply& reply) noexcept;
  void act(const request_t& request, reply_t& reply) noexcept;

  const Rig& rig_;
  BenchPlant plant_;
  std::vector<Span> troubles_;
  LineDamage to_host_, from_host_;
  std::vector<std::uint8_t> outgoing_;  // room for kLineBuffer
  std::vector<std::uint8_t> arrived_;   // scratch
  bool deaf_ = false;
  bool estop_ = false;
  bool let_go_ = false;  // the plant, since the start
  std::int64_t restarts_ = 0;

  std::int64_t now_;       // device's clock
  std::int64_t zero_ = 0;  // its time at the firmware's start; the first start: 0
  model::Input drives_;    // what the firmware asks of them
  gyrotwin_board functions_;
  gyrotwin_device device_;
};

}  // namespace gyrotwin
