// Which commands an owner obeys. Rules: messages/README.md, "Commands".
#pragma once

#include <array>
#include <cstdint>

#include "messages/channels.hpp"

namespace gyrotwin {

/// Lets commands through by epoch, age, counter and lease, and counts the others by reason.
class CommandGate {
 public:
  struct Refusals {
    std::int64_t not_finite = 0, epoch = 0, expired = 0, counter = 0, writer = 0;
  };

  /// @param timeout_ticks how long a writer keeps the lease, and when commands count as lost
  /// @param delay_ticks a command acts that many ticks after the one it is for; 0 to kMaxDelay
  CommandGate(int timeout_ticks, int delay_ticks);

  /// Starts anew at tick 0 of a run with this epoch: lease and values are gone, counts stay.
  void reset(std::int64_t owner_epoch) noexcept;

  /// @return whether the command is accepted at the owner's current tick
  bool offer(const command_t& command, std::int64_t tick) noexcept;

  /// Ends the lease: any writer may follow. For an owner whose time stands still, so that the lease
  /// cannot run out.
  void release() noexcept { leased_ = false; }

  /// The command that acts in `tick`, null when there is none or it is no longer valid.
  const command_t* acting(std::int64_t tick) noexcept;

  /// A command for exactly this tick has been accepted (what lockstep waits for).
  bool answered(std::int64_t tick) const noexcept { return newest_for_tick_ == tick; }

  /// No valid command for timeout_ticks.
  bool lost(std::int64_t tick) const noexcept { return tick - heard_tick_ >= timeout_; }

  /// Who holds the lease; 0: nobody.
  std::int64_t writer() const noexcept { return leased_ ? served_[0].writer : 0; }
  /// Of the last command that was accepted in this run.
  std::int64_t counter() const noexcept { return served_[0].counter; }
  const Refusals& refusals() const noexcept { return refusals_; }

  static constexpr int kMaxDelay = 8;
  /// Writers of a run whose counters are remembered.
  static constexpr std::size_t kMostWriters = 16;

 private:
  struct Served {
    bool known = false;
    std::int64_t writer = 0, counter = 0;  // the last accepted
  };
  Served* place_of(std::int64_t writer) noexcept;

  std::int64_t timeout_;
  std::int64_t delay_;
  std::int64_t epoch_ = 0;
  bool leased_ = false;                        // to the writer that was served last
  std::array<Served, kMostWriters> served_{};  // of this run, the last first
  std::int64_t heard_tick_ = 0;  // when a command was last accepted, by the owner's tick
  std::int64_t newest_for_tick_ = -1;
  std::array<command_t, kMaxDelay + 1> waiting_;  // accepted, not yet acting; oldest first
  int waiting_count_ = 0;
  command_t acting_{};
  bool has_acting_ = false;
  Refusals refusals_;
};

}  // namespace gyrotwin
