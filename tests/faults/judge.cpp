#include "tests/faults/judge.hpp"

#include <algorithm>

#include "services/runtime/text.hpp"

namespace gyrotwin::faults {

namespace {

/// A command that arrives while a tick is computed is heard here before that tick's STATE, but by
/// the owner only after it.
constexpr std::int64_t kComputing = 1;

}  // namespace

void Judge::hear(const support::Heard& heard) {
  if (heard.channel == Channel::kState) on_state(heard.as<state_t>());
  if (heard.channel == Channel::kCommand) on_command(heard.as<command_t>());
  if (heard.channel == Channel::kReply) on_reply(heard.as<reply_t>());
}

/// STATE k closes the tick that began as number k - 1.
void Judge::on_state(const state_t& state) {
  const auto [of_epoch, is_new] = runs_.try_emplace(state.header.epoch);
  Run& run = of_epoch->second;
  if (is_new) run.commanded = run.tick = state.header.tick;  // what came before was not heard
  const std::int64_t begun = state.header.tick - 1;
  const bool running = state.mode == status_t::MODE_RUNNING;
  if (running && state.header.tick > run.tick) {
    const std::int64_t without = begun - run.commanded;
    ticks_.longest = std::max(ticks_.longest, without);
    if (without >= timeout_ + kComputing) {
      complain(
          fmt::format("RUNNING in tick {}, {} ticks after the last valid command", begun, without));
    }
  }
  if (run.running && state.mode == status_t::MODE_SAFE_STOP) {
    ticks_.to_stop = begun - run.commanded;
    if (ticks_.to_stop > timeout_ + kComputing) {
      complain(
          fmt::format("a safe stop only {} ticks after the last valid command", ticks_.to_stop));
    }
  }
  run.running = running;
  run.tick = state.header.tick;
}

/// messages/README.md, "Commands".
void Judge::on_command(const command_t& command) {
  const auto of_epoch = runs_.find(command.owner_epoch);
  if (of_epoch == runs_.end()) return;
  Run& run = of_epoch->second;
  if (command.for_tick > run.tick || run.tick >= command.for_tick + command.valid_ticks) return;
  const bool leased = run.writer != 0 && run.tick - run.commanded < timeout_;
  if (leased && command.writer != run.writer) return;
  if (command.writer == run.writer && command.counter <= run.counter) return;
  run.writer = command.writer;
  run.counter = command.counter;
  run.commanded = run.tick;
}

/// One request acts once, however often it and its answer travel. That it is refused later is fine.
void Judge::on_reply(const reply_t& reply) {
  if (reply.result != reply_t::APPLIED) return;
  const auto [first, is_new] = applied_.try_emplace(
      {reply.header.epoch, reply.request_writer, reply.request_counter}, reply);
  const reply_t& before = first->second;
  if (before.applied_tick == reply.applied_tick && get_text(before.text) == get_text(reply.text)) {
    return;
  }
  complain(fmt::format("a request has acted twice: {}; {}", get_text(before.text),
                       get_text(reply.text)));
}

}  // namespace gyrotwin::faults
