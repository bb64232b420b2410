#include "services/runtime/command_gate.hpp"

#include <algorithm>
#include <cmath>

namespace gyrotwin {

CommandGate::CommandGate(int timeout_ticks, int delay_ticks)
    : timeout_(timeout_ticks), delay_(delay_ticks) {}

void CommandGate::reset(std::int64_t owner_epoch) noexcept {
  epoch_ = owner_epoch;
  leased_ = false;
  served_ = {};
  heard_tick_ = 0;
  newest_for_tick_ = -1;
  waiting_count_ = 0;
  has_acting_ = false;
}

/// Where the writer is remembered, or else the place of the one served longest ago.
CommandGate::Served* CommandGate::place_of(std::int64_t writer) noexcept {
  const auto found = std::find_if(served_.begin(), served_.end(), [writer](const Served& s) {
    return s.known && s.writer == writer;
  });
  return found == served_.end() ? &served_.back() : &*found;
}

bool CommandGate::offer(const command_t& command, std::int64_t tick) noexcept {
  const bool meant =
      (command.mode == command_t::TORQUE_NM || command.mode == command_t::VOLTAGE_V) &&
      command.valid_ticks >= 1 &&
      std::all_of(std::begin(command.value), std::end(command.value),
                  [](double x) { return std::isfinite(x); });
  if (!meant) {
    ++refusals_.not_finite;
    return false;
  }
  if (command.owner_epoch != epoch_) {
    ++refusals_.epoch;
    return false;
  }
  // tick - for_tick cannot overflow once for_tick is in [0, tick].
  if (command.for_tick < 0 || command.for_tick > tick ||
      tick - command.for_tick >= command.valid_ticks) {
    ++refusals_.expired;
    return false;
  }
  if (leased_ && command.writer != served_[0].writer && !lost(tick)) {
    ++refusals_.writer;
    return false;
  }
  // Of every writer of the run: one that lost the lease could otherwise be played back.
  Served* place = place_of(command.writer);
  if (place->known && place->writer == command.writer && command.counter <= place->counter) {
    ++refusals_.counter;
    return false;
  }

  leased_ = true;
  std::move_backward(served_.data(), place, place + 1);
  served_[0] = {true, command.writer, command.counter};
  heard_tick_ = tick;
  newest_for_tick_ = std::max(newest_for_tick_, command.for_tick);
  // A repeated answer takes the place of the first one: the commands of other ticks still have to
  // act.
  if (waiting_count_ > 0 && waiting_[waiting_count_ - 1].for_tick == command.for_tick) {
    --waiting_count_;
  } else if (waiting_count_ == static_cast<int>(waiting_.size())) {
    std::move(waiting_.begin() + 1, waiting_.end(), waiting_.begin());
    --waiting_count_;
  }
  waiting_[waiting_count_++] = command;
  return true;
}

const command_t* CommandGate::acting(std::int64_t tick) noexcept {
  int due = 0;
  while (due < waiting_count_ && waiting_[due].for_tick + delay_ <= tick) ++due;
  if (due > 0) {
    acting_ = waiting_[due - 1];
    has_acting_ = true;
    std::move(waiting_.begin() + due, waiting_.begin() + waiting_count_, waiting_.begin());
    waiting_count_ -= due;
  }
  if (!has_acting_) return nullptr;
  const std::int64_t age = tick - delay_ - acting_.for_tick;
  return age < acting_.valid_ticks ? &acting_ : nullptr;
}

}  // namespace gyrotwin
