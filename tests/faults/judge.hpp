// What must hold whatever happens to network, hosts and daemons, judged from all that was heard
// beside the plant. It shares no code with the owner.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/hosts.hpp"

namespace gyrotwin::faults {

/// How long the plant ran without commands, in ticks of the owner's time.
struct Ticks {
  std::int64_t longest = 0;   ///< without a valid command while RUNNING
  std::int64_t to_stop = -1;  ///< from the last valid command to the last safe stop; -1: none
};

class Judge {
 public:
  explicit Judge(std::int64_t timeout_ticks) : timeout_(timeout_ticks) {}

  void hear(const support::Heard& heard);

  const Ticks& ticks() const { return ticks_; }
  /// Empty when all holds.
  const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  /// One run of an owner.
  struct Run {
    bool running = false;
    std::int64_t tick = 0;       // of its newest STATE
    std::int64_t commanded = 0;  // tick in which the newest valid command came
    std::int64_t writer = 0;     // who holds the lease
    std::int64_t counter = 0;
  };

  void on_state(const state_t& state);
  void on_command(const command_t& command);
  void on_reply(const reply_t& reply);
  void complain(std::string text) { complaints_.push_back(std::move(text)); }

  std::int64_t timeout_;
  std::map<std::int64_t, Run> runs_;                        // by epoch
  std::map<std::array<std::int64_t, 3>, reply_t> applied_;  // by owner's run, writer and counter
  Ticks ticks_;
  std::vector<std::string> complaints_;
};

}  // namespace gyrotwin::faults
