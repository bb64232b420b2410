// An emulated rig in wall time: between clock, terminal and emulator.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/rig_emulator/device_clock.hpp"
#include "clients/rig_emulator/emulator.hpp"
#include "clients/rig_emulator/terminal.hpp"
#include "clients/rig_emulator/truth_file.hpp"
#include "services/runtime/daemon.hpp"
#include "services/runtime/pacer.hpp"

namespace gyrotwin {

/// What the command line asks for beside the rig and the line.
struct EmulatorOptions {
  double clock_offset_s = 0.0, clock_drift_ppm = 0.0;
  std::vector<std::string> troubles;
  bool from_stdin = false;
  std::string truth;            ///< file; empty: none
  double truth_period_s = 0.0;  ///< between two rows; every tick at least
};

class Runner {
 public:
  /// All references outlive it.
  /// @throws Error where an option makes no sense
  Runner(const Rig& rig, const EmulatorOptions& options, Terminal& terminal, Daemon& daemon);

  /// Until the daemon stops, or the terminal is gone.
  void run();
  /// Everything of --truth has been written.
  bool sound() const { return !truth_ || truth_->sound(); }

 private:
  void rest();
  void receive();
  void tick(std::int64_t now);
  void drain();
  void ask();
  void follow();
  void conclude();

  Terminal& terminal_;
  Daemon& daemon_;
  MonotonicClock host_;
  DeviceClock clock_;
  Emulator emulator_;
  Pacer pacer_;
  bool asking_;  // standard input is open
  std::string asked_;
  std::optional<TruthFile> truth_;
  std::int32_t followed_mode_ = GYROTWIN_HELD;
  std::int64_t followed_restarts_ = 0;
  std::int64_t share_due_ = 0;
};

}  // namespace gyrotwin
