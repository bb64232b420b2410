#include "services/controller/controller.hpp"

#include <algorithm>
#include <iterator>

#include "services/runtime/error.hpp"
#include "services/runtime/observation_wire.hpp"

namespace gyrotwin {

Controller::Controller(const Rig& rig, std::int64_t writer)
    : rig_(rig),
      machine_(rig.build_machine()),
      needed_(groups_for_laws(machine_)),
      law_(rig, machine_),
      writer_(writer) {
  if (law_.law() == nullptr) {
    throw Error(
        rig.file.string() +
        ": [controller] law is \"none\", so there is nothing to control; name a law, or run "
        "the integrator alone with --set loop.clock=free");
  }
}

void Controller::on_owner(const status_t& status) noexcept {
  if (status.header.epoch == owner_epoch_) return;
  owner_epoch_ = status.header.epoch;
  answered_sequence_ = -1;
}

bool Controller::answer(const state_t& state, command_t& command) noexcept {
  if (state.header.epoch != owner_epoch_ || state.mode != status_t::MODE_RUNNING) return false;
  if ((state.valid & needed_) != needed_) return false;

  if (state.header.sequence != answered_sequence_) {
    const model::Observation seen = from_wire(state);
    if (answered_sequence_ < 0) law_.reset(seen);
    torques_ = law_.step(seen);
    answered_sequence_ = state.header.sequence;
  }

  command.mode = command_t::TORQUE_NM;
  command.valid_ticks = rig_.safety.command_timeout_ticks;
  std::copy(torques_.begin(), torques_.end(), std::begin(command.value));
  command.for_tick = state.header.tick;
  command.owner_epoch = owner_epoch_;
  command.writer = writer_;
  command.counter = ++counter_;
  return true;
}

}  // namespace gyrotwin
